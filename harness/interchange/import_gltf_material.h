// Converts glTF materials, core and extensions, to those of scene files. Only for files compiled with tinygltf.
#pragma once

#include <map>
#include <optional>

#include "harness/interchange/import_draft.h"
#include "harness/interchange/import_gltf_image.h"
#include "harness/mesh/gltf_model.h"

namespace pt {

class GltfMaterials {
public:
    GltfMaterials(const tinygltf::Model& model, ImportDraft& draft)
        : model_(&model), draft_(&draft), images_(model, draft) {}

    // Converts a glTF material (-1: glTF's default) and returns its number in the draft. Returns nothing, after
    // reporting a problem, if scene files cannot express the material.
    std::optional<std::size_t> material_of(int index);

private:
    struct Reader;
    std::optional<std::size_t> read(int index);

    const tinygltf::Model* model_;
    ImportDraft* draft_;
    GltfImages images_;
    std::map<int, std::optional<std::size_t>> known_;
};

}  // namespace pt
