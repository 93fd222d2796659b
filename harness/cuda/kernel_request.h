// What is compiled for a variant of a scene on a GPU ("sm_90"): for its integrator, and of the sources that its choices
// ask for.
#pragma once

#include "harness/scene/scene.h"
#include "variants/cuda/module.h"
#include "variants/descriptor.h"

namespace pt::cuda {

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture);
// All programs that a render of the variant loads: the integrator's, and those of a compaction and a sort that have
// kernels of their own.
std::vector<ModuleRequest> module_requests(const Scene& scene, const Variant& variant, const std::string& architecture);
// `kernels`: those of the source that are launched.
ModuleRequest stage_request(const Variant& variant, const std::string& source,
                            const std::vector<KernelSignature>& kernels, const std::string& architecture);
// The embedded source of the variant's integrator.
std::string integrator_source(const Variant& variant);

}  // namespace pt::cuda
