// Radiance images that light comes from.
#include <cmath>

#include "harness/scene/environment_image.h"
#include "tests/fuzz/findings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::accept_or_refuse([&] {
        const pt::EnvironmentImage image = pt::parse_hdr({reinterpret_cast<const char*>(data), size}, "image");
        pt::fuzz::require(image.texels.size() == std::size_t{image.width} * image.height, "an image of another size");
        for (const pt::Vec3<float>& texel : image.texels) {
            pt::fuzz::require(std::isfinite(texel.x + texel.y + texel.z), "a texel that is not finite");
        }
    });
    return 0;
}
