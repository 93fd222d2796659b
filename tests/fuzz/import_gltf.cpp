// glTF scenes, binary or JSON.
#include "harness/interchange/import_gltf.h"

#include "harness/scene/scene_mesh.h"
#include "harness/scene/texture_image.h"
#include "tests/fuzz/imports.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const pt::ImportResult result = pt::import_gltf(pt::fuzz::source_of(data, size, "scene.gltf"));
    pt::MeshesToBe::Meshes meshes;
    for (const pt::ImportedMesh& imported : result.meshes) {
        meshes[imported.file] = pt::make_scene_mesh(imported.mesh, imported.file, true);
    }
    const pt::MeshesToBe to_be(std::move(meshes));
    pt::ImagesToBe::Contents images;
    for (const pt::ImportedImage& imported : result.images) {
        images[imported.file] = imported.content;
    }
    const pt::ImagesToBe images_to_be(std::move(images));
    pt::fuzz::require_import(result);
    return 0;
}
