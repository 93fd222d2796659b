// Lights are selected uniformly, each as often as every other (kernels/light_selection.h).
#include "variants/registry.h"

namespace pt::light_selection::uniform {
namespace {

const Registration registration(
    {
        .axis = "light_selection",
        .name = "uniform",
        .summary = "each light as often as every other",
        .origin = "Shirley, Wang and Zimmerman 1996",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::light_selection::uniform
