#include "harness/cuda/loaded_modules.h"

#include <map>
#include <memory>

namespace pt::cuda {

const Module& loaded_module(const ModuleRequest& request, CudaFacts& facts) {
    static std::map<std::string, std::unique_ptr<Module>> modules;
    std::unique_ptr<Module>& module = modules[module_key(request)];
    if (module == nullptr) {
        const ModuleImage image = build_module(request);
        module = std::make_unique<Module>(image);
        facts.compile_seconds += image.compile_seconds;
        facts.from_cache = facts.from_cache && image.from_cache;
    }
    return *module;
}

}  // namespace pt::cuda
