#include "harness/cuda/loaded_modules.h"

#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt::cuda {

namespace {

std::string request_text(const ModuleRequest& request) {
    return fmt::format("{}|{}|{}|{}|{}|{}|{}|{}|{}", request.prelude, request.name, request.features, request.real,
                       request.layout, request.sort_key, request.architecture, fmt::join(request.options, " "),
                       fmt::join(request.defines, " "));
}

}  // namespace

const Module& loaded_module(const ModuleRequest& request, CudaFacts& facts) {
    static std::map<std::string, std::unique_ptr<Module>> modules;
    std::unique_ptr<Module>& module = modules[request_text(request)];
    if (module == nullptr) {
        const ModuleImage image = build_module(request);
        module = std::make_unique<Module>(image);
        facts.compile_seconds += image.compile_seconds;
        facts.from_cache = facts.from_cache && image.from_cache;
    }
    return *module;
}

}  // namespace pt::cuda
