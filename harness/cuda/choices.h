// Hooks and tunables of a variant's choices on the CUDA backend.
#pragma once

#include "variants/registry.h"

namespace pt::cuda {

inline const Hooks& hooks(std::string_view axis, const Variant& variant) {
    return Registry::instance().at(axis, variant, Backend::cuda).hook.cuda;
}

// The value of a tunable in the variant, or `otherwise` if no choice of the variant has the tunable.
inline std::uint32_t tuned(const Variant& variant, std::string_view name, std::uint32_t otherwise) {
    for (const Tunable& known : tunables_of(variant, Backend::cuda)) {
        if (known.name == name) {
            return tunable(variant, name, Backend::cuda);
        }
    }
    return otherwise;
}

// Camera rays per pixel that the first-bounce cache keeps; 0 if there is no cache.
inline std::uint32_t kept_rays(const Variant& variant) {
    return Registry::instance()
        .at(axes::first_bounce, variant, Backend::cuda)
        .hook.first_bounce(variant, Backend::cuda);
}

}  // namespace pt::cuda
