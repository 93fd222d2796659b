// The images of a glTF file that surfaces show: beside it, or in it and then to be written beside the scene. Only for
// files that are compiled with tinygltf.
#pragma once

#include <map>
#include <set>
#include <string>

#include "harness/interchange/import_draft.h"
#include "harness/mesh/gltf_model.h"

namespace pt {

struct GltfImage {
    std::string value;  // of a colour in the scene file: {"image": NAME}; empty: it cannot be shown
    bool has_alpha = false;
    std::string refusal = {};  // what a texture would have to be
};

class GltfImages {
public:
    GltfImages(const tinygltf::Model& model, ImportDraft& draft) : model_(&model), draft_(&draft) {}

    GltfImage of_texture(int texture);

private:
    std::string sampler_refusal(int sampler);
    const GltfImage& image(int index);
    GltfImage read(int index);
    GltfImage read_beside(const std::string& uri) const;
    std::string embedded_content(const tinygltf::Image& image) const;

    const tinygltf::Model* model_;
    ImportDraft* draft_;
    std::map<int, GltfImage> known_;  // by image
    std::set<int> noted_;             // samplers
};

}  // namespace pt
