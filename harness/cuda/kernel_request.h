// Determines the programs, sources and options, needed to render a scene with a variant on a GPU ("sm_90").
#pragma once

#include "harness/scene/scene.h"
#include "variants/cuda/runtime/module.h"
#include "variants/descriptor.h"
#include "variants/registry.h"

namespace pt::cuda {

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture);
// The requests for all programs that a render with the variant loads: the integrator's and those of its stages.
std::vector<ModuleRequest> module_requests(const Scene& scene, const Variant& variant, const std::string& architecture);
// The request for a compaction or sorting stage whose kernels NVRTC compiles; the stage need not be the variant's own.
ModuleRequest stage_request(const Variant& variant, const Choice& stage, const std::string& architecture);
// The variant's choices of compaction and sorting that have a stage on the device; none without a queue.
std::vector<const Choice*> stages_of(const Variant& variant);
// The embedded source file of the variant's integrator.
std::string integrator_source(const Variant& variant);

}  // namespace pt::cuda
