// The choice partition=samples: each GPU takes its contiguous share of every pixel's samples, as MPI ranks do
// (harness/ranks).
#include "variants/registry.h"

namespace pt::partition::samples {
namespace {

const Registration registration(
    {
        .axis = "partition",
        .name = "samples",
        .summary = "of every pixel's samples each GPU takes an equal share, one after the other",
        .origin = "ptbench",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::partition::samples
