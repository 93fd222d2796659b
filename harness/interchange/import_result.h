// What every importer of a foreign scene is given, and what it gives back: a scene file, or all that is in its way.
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
    std::string text;  // of the file, whole
    std::string file;  // its name: what it names is looked for near it
    std::string out;   // the scene file to be written; empty: none is, and names of meshes are relative to `file`
    std::string name;  // of the scene; empty: what the file says
};

// A mesh that the scene file names and that no file has yet.
struct ImportedMesh {
    std::string file;  // .ply, in the scene file's folder
    Mesh mesh;
};

// An image that is to be written beside the scene, as it lay in the source.
struct ImportedImage {
    std::string file, content;
};

struct ImportResult {
    ImportResult() = default;
    explicit ImportResult(const ImportSource& source) : files(source.out) {}

    std::string json;  // the scene file's text; empty where there are problems
    std::vector<ImportedMesh> meshes;
    std::vector<ImportedImage> images;
    FilesBeside files;  // those meshes and images, as they are written
    ImportFindings problems, warnings, notes;
    std::set<std::string> meshes_told;  // files whose own warnings are among `warnings`
    std::size_t objects = 0, materials = 0;
};

// Texts beyond this size are not read, in bytes: it holds 10^5 objects.
inline constexpr std::size_t largest_import = std::size_t{16} << 20;
// Most bytes of a glTF file, which holds meshes, or has them beside it.
inline constexpr std::size_t largest_gltf = std::size_t{1} << 30;

}  // namespace pt
