// The choice subsurface_sampling=classical: subsurface walks as light makes them, directions by the phase function,
// free paths by sigma_t (kernels/materials/subsurface.h).
#include "variants/registry.h"

namespace pt::subsurface_sampling::classical {
namespace {

const Registration registration(
    {
        .axis = "subsurface_sampling",
        .name = "classical",
        .summary = "directions by the phase function, flights by the medium",
        .origin = "the usual random walk",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::subsurface_sampling::classical
