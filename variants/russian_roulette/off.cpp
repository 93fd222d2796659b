// No Russian roulette: paths go on until they leave the scene, meet a light or have their full length.
#include "variants/registry.h"

namespace pt::russian_roulette::off {
namespace {

const Registration registration(
    {
        .axis = "russian_roulette",
        .name = "off",
        .summary = "paths end where the scene or their length ends them",
        .origin = "cis565",
        .baseline = on_every_backend,
        .traits = RouletteTraits{.ends_paths = false},
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::russian_roulette::off
