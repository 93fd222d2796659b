#include "variants/variant_name.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "variants/fnv1a.h"
#include "variants/registry.h"

namespace pt {

namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

// The choices and tunables that a variant's shown name lists after the integrator: those that differ from the baseline.
Pairs differences(const Variant& variant, Backend backend) {
    const Variant baseline = Registry::instance().baseline(backend);
    Pairs differing;
    for (const std::string_view axis : axis_names) {
        if (axis != axes::integrator && variant[axis] != baseline[axis]) {
            differing.emplace_back(axis, variant[axis]);
        }
    }
    for (const auto& [tunable, value] : variant.tuning) {
        differing.emplace_back(tunable, std::to_string(value));
    }
    return differing;
}

std::string joined(const Variant& variant, Backend backend, char between, char is) {
    std::string text = variant[axes::integrator];
    for (const auto& [name, value] : differences(variant, backend)) {
        text += between + name + is + value;
    }
    return text;
}

// Names and values of all tunables of the variant's choices on the backend, but for values of Tunable::as_before.
Pairs tunable_values(const Variant& variant, Backend backend) {
    Pairs values;
    for (const std::string_view axis : axis_names) {
        const Choice* choice = Registry::instance().find(axis, variant[axis], backend);
        for (const Tunable& tunable : choice == nullptr ? std::span<const Tunable>{} : choice->descriptor.tunables) {
            const auto tuned = variant.tuning.find(tunable.name);
            const std::uint32_t value =
                tuned == variant.tuning.end() ? tunable_in(variant, tunable, backend).default_value : tuned->second;
            if (tunable.as_before != value) {
                values.emplace_back(tunable.name, std::to_string(value));
            }
        }
    }
    return values;
}

}  // namespace

std::string shown_name(const Variant& variant, Backend backend) { return joined(variant, backend, ' ', '='); }

std::string benchmark_name(const Variant& variant, Backend backend) { return joined(variant, backend, '/', ':'); }

std::string variant_id(const Variant& variant, Backend backend) {
    Pairs parts = tunable_values(variant, backend);
    for (const Axis& axis : axis_table) {
        if (variant[axis.key] != axis.as_before) {
            parts.emplace_back(axis.key, variant[axis.key]);
        }
    }
    std::sort(parts.begin(), parts.end());
    std::uint64_t hash = fnv1a_start;
    for (const auto& [name, value] : parts) {
        hash = fnv1a(name + "=" + value + "\n", hash);
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace pt
