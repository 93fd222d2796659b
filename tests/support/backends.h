// What this build has. Without a CUDA toolkit some axes have no choice on that backend, so it has no variants.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <fmt/ranges.h>

#include "choices_not_built.h"  // generated
#include "variants/registry.h"

namespace pt::test {

inline bool cuda_is_built() { return !Registry::instance().choices("integrator", Backend::cuda).empty(); }

inline std::vector<Backend> built_backends() {
    return cuda_is_built() ? std::vector<Backend>{Backend::cpu, Backend::cuda} : std::vector<Backend>{Backend::cpu};
}

// The choices of an axis, and the tunables, of all backends as messages list them: each once, sorted. A choice that
// this build lacks is listed too.
inline std::string choice_names(std::string_view axis) {
    std::set<std::string_view> names;
    for (const Backend backend : all_backends) {
        for (const Choice* choice : Registry::instance().choices(axis, backend)) {
            names.insert(choice->descriptor.name);
        }
    }
    for (const auto& [other_axis, name] : choices_not_built) {
        if (other_axis == axis) {
            names.insert(name);
        }
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

inline std::string tunable_names() {
    std::set<std::string_view> names;
    for (const Backend backend : all_backends) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                for (const Tunable& tunable : choice->descriptor.tunables) {
                    names.insert(tunable.name);
                }
            }
        }
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace pt::test
