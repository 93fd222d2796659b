// Exports a scene as Mitsuba 3 XML, and beside it meshes as PLY files, the environment as an EXR file and copies of the
// textures. docs/other_renderers.md has the conventions and the remaining differences.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "harness/files_beside.h"
#include "harness/mesh/mesh.h"
#include "harness/scene/scene.h"

namespace pt {

struct MitsubaSettings {
    std::uint32_t width = 0, height = 0, depth = 1, samples = 64;
    double scale = 1;  // factor on every length in the exported scene
};

struct MitsubaScene {
    std::string xml;
    FilesBeside files;  // mesh and image files that the scene's XML names
    std::size_t meshes = 0, images = 0;
};

// Converts a scene to Mitsuba XML. The scene must have no `mitsuba_problems`. `out` is the path of the XML file, from
// which the names of the other files follow.
MitsubaScene mitsuba_scene(const Scene& scene, const MitsubaSettings& settings, const std::filesystem::path& out);

// Converts a scene's mesh to an indexed mesh that has each corner once, with texture coordinates.
Mesh indexed_mesh(const SceneMesh& mesh);

}  // namespace pt
