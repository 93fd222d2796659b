// Double precision throughout; random numbers have 32 bits instead of 24. On the CPU for the plainest kernel only: it
// is there for references, not for speed.
#include "variants/registry.h"

namespace pt {
namespace {

constexpr Descriptor descriptor{
    .axis = "precision",
    .name = "double",
    .summary = "double precision throughout",
    .origin = "the usual check on single precision",
    .claim = Claim::statistical,
    .claim_note = "same expectation as precision=float, up to rounding",
    .mean_of = "float",
    .backends = on_cuda,
};

const Registration on_the_gpu(descriptor, {.cuda = {.real = "double", .real_bytes = 8}});

std::string why_not_on_the_cpu(FeatureSet, const Variant& variant) {
    const Hook& integrator = Registry::instance().at("integrator", variant, Backend::cpu).hook;
    if (integrator.integrator_in_double.empty()) {
        return "is compiled for a path at a time: needs integrator=depth_first, not " + variant["integrator"];
    }
    if (variant["specialisation"] != "generic") {
        return "is compiled with every feature only: needs specialisation=generic, not " + variant["specialisation"];
    }
    return "";
}

constexpr Descriptor cpu_descriptor() {
    Descriptor on_the_cpu = descriptor;
    on_the_cpu.backends = on_cpu;
    on_the_cpu.unsupported_reason = why_not_on_the_cpu;
    return on_the_cpu;
}

const Registration on_the_cpu(cpu_descriptor(), {.is_double = true});

}  // namespace
}  // namespace pt
