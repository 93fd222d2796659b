// Imports texture images of a glTF file: those beside the file, and embedded ones, which are written beside the scene.
// Only for files compiled with tinygltf.
#pragma once

#include <map>
#include <set>
#include <string>

#include "harness/interchange/import_draft.h"
#include "harness/mesh/gltf_model.h"

namespace pt {

struct GltfImage {
    std::string value;  // texture as the scene file has it, {"image": NAME}; empty: refused
    bool has_alpha = false;
    std::string refusal = {};  // what is allowed in place of a texture that cannot be imported, for the error message
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
    std::map<int, GltfImage> known_;  // glTF images converted so far, by index in the model
    std::set<int> noted_;             // glTF samplers that a note has reported
};

}  // namespace pt
