// What is compiled for a variant of a scene on a GPU ("sm_90"): for its integrator, and of the sources that its choices
// ask for.
#pragma once

#include "harness/scene/scene.h"
#include "variants/cuda/runtime/module.h"
#include "variants/descriptor.h"
#include "variants/registry.h"

namespace pt::cuda {

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture);
// The requests of all programs that a render of the variant loads: the integrator's, and those of its stages.
std::vector<ModuleRequest> module_requests(const Scene& scene, const Variant& variant, const std::string& architecture);
// The request of a compaction or sorting whose kernels NVRTC compiles, whatever the variant's own is.
ModuleRequest stage_request(const Variant& variant, const Choice& stage, const std::string& architecture);
// The compaction and the sorting that the variant's queue is given; none where it has no queue, or needs none.
std::vector<const Choice*> stages_of(const Variant& variant);
// The embedded source of the variant's integrator.
std::string integrator_source(const Variant& variant);

}  // namespace pt::cuda
