// A scene as Mitsuba 3's XML, with its meshes as PLY files, its environment as an EXR file and copies of the images
// that surfaces show beside it. Conventions, and what differs all the same: docs/other_renderers.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/mesh/mesh.h"
#include "harness/scene/scene.h"

namespace pt {

struct MitsubaSettings {
    std::uint32_t width = 0, height = 0, depth = 1, samples = 64;
    double scale = 1;  // every length times it
};

struct MitsubaScene {
    std::string xml;
    std::vector<std::uint32_t> meshes;  // indices into Scene::meshes; the n-th is the file mesh_files[n] that xml names
    std::vector<std::string> mesh_files;
    std::vector<std::pair<std::string, std::string>>
        images;                                 // names that xml has, and the files that they are copies of
    std::string environment_file, environment;  // the name and content of an image that xml names; empty: none
};

// Of a scene without mitsuba_problems. `stem` begins the names of the mesh files.
MitsubaScene mitsuba_scene(const Scene& scene, const MitsubaSettings& settings, const std::string& stem);

// The triangles with each corner once, and their texture coordinates.
Mesh indexed_mesh(const SceneMesh& mesh);

}  // namespace pt
