// Light sampling that adapts to distance: a far light is sampled as by `projected`, and a near one by one of its faces
// with weights that are bounded (kernels/light_sampling.h, kernels/near_rectangle.h).
#include "variants/light_sampling/light_sampling.h"

namespace pt::light_sampling::automatic {
namespace {

constexpr Tunable tunables[] = {
    {"near_light", 70, 0, 1000, 1, "a box or quad that emits is near within so many hundredths of half its diagonal",
     true},
};

const Registration registration(
    {
        .axis = "light_sampling",
        .name = "auto",
        .summary = "boxes and quads as projected, and where near to a face drawn at random, with bounded weights",
        .origin = "Shirley, Wang and Zimmerman 1996; Urena, Fajardo and King 2013",
        .claim = Claim::statistical,
        .claim_note = light_sampling_claim,
        .mean_of = "solid_angle",
        .traits = LightSamplingTraits{.is_by_solid_angle = false},
        .backends = on_every_backend,
        .tunables = tunables,
        .unsupported_reason = light_sampling_unsupported_reason,
    },
    {.features = [] { return no_features | Feature::automatic_sampling; }});

}  // namespace
}  // namespace pt::light_sampling::automatic
