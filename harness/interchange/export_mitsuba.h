// A scene as Mitsuba 3's XML, with its meshes as PLY files, its environment as an EXR file and copies of the images
// that surfaces show beside it. Conventions, and what differs all the same: docs/other_renderers.md.
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
    double scale = 1;  // every length times it
};

struct MitsubaScene {
    std::string xml;
    FilesBeside files;  // what xml names
    std::size_t meshes = 0, images = 0;
};

// The scene as Mitsuba's XML. Precondition: it has no mitsuba_problems. `out`: the file that it is to be written to,
// from which the names of the others follow.
MitsubaScene mitsuba_scene(const Scene& scene, const MitsubaSettings& settings, const std::filesystem::path& out);

// The triangles with each corner once, and their texture coordinates.
Mesh indexed_mesh(const SceneMesh& mesh);

}  // namespace pt
