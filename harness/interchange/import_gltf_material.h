// The materials of a glTF file, core and extensions, as those of scene files. Only for files that are compiled with
// tinygltf.
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

    // The material's number in the draft, -1 being glTF's own; nothing, and a problem, where scene files have none
    // such.
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
