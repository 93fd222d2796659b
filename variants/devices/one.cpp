// The choice devices=1: renders on the first GPU (on the CPU backend: on the host).
#include "variants/registry.h"

namespace pt::devices::one {
namespace {

const Registration registration(
    {
        .axis = "devices",
        .name = "1",
        .summary = "one GPU",
        .origin = "ptbench",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::devices::one
