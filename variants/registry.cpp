#include "variants/registry.h"

#include <algorithm>
#include <stdexcept>

namespace pt {

Registry& Registry::instance() {
    static Registry registry;
    return registry;
}

namespace {

// Throws std::logic_error for a descriptor that verification could not work with.
void check_descriptor(const Descriptor& descriptor) {
    Variant::index(descriptor.axis);
    if (descriptor.claim == Claim::statistical && descriptor.mean_of.empty()) {
        throw std::logic_error("a statistical claim needs mean_of: " + std::string(descriptor.axis) + "=" +
                               std::string(descriptor.name));
    }
}

}  // namespace

void Registry::add(const Descriptor& descriptor, Hook hook) {
    check_descriptor(descriptor);
    const auto [position, inserted] = axes_[std::string(descriptor.axis)].try_emplace(
        std::string(descriptor.name), Choice{descriptor, std::move(hook)});
    if (!inserted) {
        throw std::logic_error("choice registered twice: " + std::string(descriptor.axis) + "=" + position->first);
    }
}

void Registry::add_integrator(const Descriptor& descriptor, FeatureSet features, RenderFunction render) {
    check_descriptor(descriptor);
    Choice& choice =
        axes_["integrator"].try_emplace(std::string(descriptor.name), Choice{descriptor, {}}).first->second;
    choice.hook.integrator[features] = render;
}

std::vector<const Choice*> Registry::choices(std::string_view axis) const {
    std::vector<const Choice*> found;
    if (const auto position = axes_.find(std::string(axis)); position != axes_.end()) {
        for (const auto& [name, choice] : position->second) {
            found.push_back(&choice);
        }
    }
    std::stable_partition(found.begin(), found.end(), [](const Choice* choice) { return choice->descriptor.baseline; });
    return found;
}

const Choice* Registry::find(std::string_view axis, std::string_view name) const {
    const auto position = axes_.find(std::string(axis));
    if (position == axes_.end()) {
        return nullptr;
    }
    const auto choice = position->second.find(std::string(name));
    return choice == position->second.end() ? nullptr : &choice->second;
}

const Choice& Registry::at(std::string_view axis, const Variant& variant) const {
    const Choice* choice = find(axis, variant[axis]);
    if (choice == nullptr) {
        throw std::logic_error("no choice " + std::string(axis) + "=" + variant[axis]);
    }
    return *choice;
}

Variant Registry::baseline() const {
    Variant variant;
    for (const std::string_view axis : axis_names) {
        variant.set(axis, std::string(choices(axis).at(0)->descriptor.name));
    }
    return variant;
}

Variant Registry::reference(const Variant& variant) const {
    Variant reference = baseline();
    for (const std::string_view axis : axis_names) {
        if (at(axis, variant).descriptor.claim != Claim::bitwise) {
            reference.set(axis, variant[axis]);
            continue;
        }
        for (const Choice* choice : choices(axis)) {
            if (choice->descriptor.reference) {
                reference.set(axis, std::string(choice->descriptor.name));
            }
        }
    }
    return reference;
}

std::string why_not_applicable(const Variant& variant, FeatureSet scene) {
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = Registry::instance().at(axis, variant).descriptor;
        const std::string reason =
            descriptor.does_not_apply == nullptr ? "" : descriptor.does_not_apply(scene, variant);
        if (!reason.empty()) {
            return std::string(axis) + "=" + std::string(descriptor.name) + " " + reason;
        }
    }
    return "";
}

Claim claim_of(const Variant& variant) {
    Claim weakest = Claim::bitwise;
    for (const std::string_view axis : axis_names) {
        weakest = std::max(weakest, Registry::instance().at(axis, variant).descriptor.claim);
    }
    return weakest;
}

std::string work_missing(const Variant& variant, const WorkCounters& work, std::uint64_t samples) {
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = Registry::instance().at(axis, variant).descriptor;
        const std::string missing = descriptor.work_missing == nullptr ? "" : descriptor.work_missing(work, samples);
        if (!missing.empty()) {
            return std::string(axis) + "=" + std::string(descriptor.name) + ": " + missing;
        }
    }
    return "";
}

}  // namespace pt
