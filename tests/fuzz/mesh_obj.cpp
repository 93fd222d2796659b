// Wavefront .obj meshes.
#include "tests/fuzz/mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::parse_mesh(pt::parse_obj, data, size);
    return 0;
}
