// Libraries of materials for .obj meshes (.mtl).
#include "harness/mesh/obj_materials.h"
#include "tests/fuzz/findings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pt;
    fuzz::accept_or_refuse([&] {
        for (const MtlMaterial& material : parse_mtl({reinterpret_cast<const char*>(data), size}, "library")) {
            fuzz::require(!material.name.empty() && material.line > 0, "a material without a name");
            for (const auto& [key, line] : material.lines) {
                fuzz::require(!key.empty() && !line.words.empty() && line.number > material.line,
                              "a line of no material");
            }
        }
    });
    return 0;
}
