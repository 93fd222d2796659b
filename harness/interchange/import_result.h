// Input and output of every importer of foreign scenes: the result is a scene file, or all problems that prevent it.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "harness/files_beside.h"
#include "harness/interchange/import_findings.h"
#include "harness/mesh/mesh.h"

namespace pt {

struct ImportSource {
    std::string text;  // content of the source file
    std::string file;  // path of the source file, near which files that it names are searched
    std::string out;   // path of the scene file to write; empty: none is written, and mesh names are relative to `file`
    std::string name;  // name of the scene; empty: from the source file
};

// A mesh that the scene file names and that still has to be written.
struct ImportedMesh {
    std::string file;  // name of the mesh file (.ply) in the scene file's folder
    Mesh mesh;
};

// An image to be written beside the scene, as the bytes that the source had.
struct ImportedImage {
    std::string file, content;
};

struct ImportResult {
    ImportResult() = default;
    explicit ImportResult(const ImportSource& source) : files(source.out) {}

    std::string json;  // text of the scene file; empty if there are problems
    std::vector<ImportedMesh> meshes;
    std::vector<ImportedImage> images;
    FilesBeside files;  // files to be written beside the scene file: encoded meshes and images
    ImportFindings problems, warnings, notes;
    std::set<std::string> meshes_told;  // mesh files whose own warnings are among `warnings` already
    std::size_t objects = 0, materials = 0;
};

// Most bytes of a source file in a text format, enough for 10^5 objects.
inline constexpr std::size_t largest_import = std::size_t{16} << 20;
// Most bytes of a glTF file, which may contain its meshes.
inline constexpr std::size_t largest_gltf = std::size_t{1} << 30;

}  // namespace pt
