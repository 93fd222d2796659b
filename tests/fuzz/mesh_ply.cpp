// Stanford .ply meshes.
#include "tests/fuzz/mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::parse_mesh(pt::parse_ply, data, size);
    return 0;
}
