// The choice precision=double: double precision throughout; random numbers have 32 bits instead of 24. On the CPU only
// the plainest kernel has it: for references, not for speed.
#include "variants/precision/kernels_in_double.h"

namespace pt::precision::double_ {
namespace {

constexpr Descriptor descriptor{
    .axis = "precision",
    .name = "double",
    .summary = "double precision throughout",
    .origin = "the usual check on single precision",
    .claim = Claim::statistical,
    .claim_note = "same expectation as precision=float, up to rounding",
    .mean_of = "float",
    .traits = PrecisionTraits{.real_bytes = sizeof(double), .intersects_in_double = true},
    .backends = on_cuda,
};

const Registration on_the_gpu(descriptor, {.cuda = {.real = "double"}});

Reason why_not_on_the_cpu(FeatureSet, const VariantTraits& variant) {
    if (Reason reason = needs_kernel_in_double(variant); !reason.empty()) {
        return reason;
    }
    if (!variant.specialisation.is_generic) {
        return {"needs_generic_kernel", "is compiled with every feature only: needs specialisation=generic, not " +
                                            std::string(variant.specialisation.name)};
    }
    return {};
}

constexpr Descriptor cpu_descriptor() {
    Descriptor on_the_cpu = descriptor;
    on_the_cpu.backends = on_cpu;
    on_the_cpu.unsupported_reason = why_not_on_the_cpu;
    return on_the_cpu;
}

const Registration on_the_cpu(cpu_descriptor(), {});

}  // namespace
}  // namespace pt::precision::double_
