// The choice specialisation=features: a kernel that contains what the scene needs and as little else as possible. On
// the CPU kernels are compiled ahead of time, for the feature sets in cpu_feature_sets.txt; another scene gets the
// smallest of them that has all it needs, and the output names what was compiled in for nothing.
//
// On CUDA this choice without shortcuts (room=0) is the reference: NVRTC takes many times as long for a kernel with
// every feature, and every verification and every run would wait for it first. The reference is sound, since nothing
// that it leaves out is met by the scene, and what is left are the plain formulas, one path at a time, every object and
// every triangle in turn. And it is not trusted: its film is held to that of the CPU's reference, which has every
// feature and comes from another compiler (Verifier::against_cpu). The kernel with every feature (generic) is verified
// against it as any other choice, and in tests/gpu/gate_test.cpp.
#include "variants/specialisation/smallest_superset.h"

namespace pt::specialisation::features {
namespace {

const Registration registration(
    {
        .axis = "specialisation",
        .name = "features",
        .summary = "a kernel with only the features that the scene needs",
        .origin = "Cycles' kernel feature masks",
        .baseline = on_every_backend,
        .reference = on_cuda,
        .backends = on_every_backend,
        .tunables = feature_tunables,
    },
    {.specialisation = smallest_superset});

}  // namespace
}  // namespace pt::specialisation::features
