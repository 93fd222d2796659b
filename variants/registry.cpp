#include "variants/registry.h"
#include "variants/variant_name.h"

#include <algorithm>
#include <stdexcept>

namespace pt {

Registry& Registry::instance() {
    static Registry registry;
    return registry;
}

namespace {

std::string label(const Descriptor& descriptor) {
    return std::string(descriptor.axis) + "=" + std::string(descriptor.name);
}

// Throws std::logic_error for a choice's descriptor that verification could not work with.
void check_descriptor(const Descriptor& descriptor) {
    const std::size_t axis = Variant::index(descriptor.axis);
    if (!std::holds_alternative<std::monostate>(descriptor.traits) && descriptor.traits.index() != axis + 1) {
        throw std::logic_error("traits of another axis: " + label(descriptor));
    }
    if (descriptor.claim == Claim::statistical && descriptor.mean_of.empty()) {
        throw std::logic_error("a statistical claim needs mean_of: " + label(descriptor));
    }
    if (descriptor.fp_relaxed && descriptor.claim != Claim::statistical) {
        throw std::logic_error("what rounds freely can claim its mean only: " + label(descriptor));
    }
    for (const Tunable& tunable : descriptor.tunables) {
        if (!tunable.allows(tunable.default_value) ||
            !tunable.allows(tunable.generic_value.value_or(tunable.default_value))) {
            throw std::logic_error("the standard of " + std::string(tunable.name) +
                                   " is not allowed: " + label(descriptor));
        }
    }
}

const Descriptor& descriptor_at(std::string_view axis, const Variant& variant, Backend backend) {
    return Registry::instance().at(axis, variant, backend).descriptor;
}

// Descriptors of a variant's choices, in the order of the axes; null for a choice that no backend has.
using Descriptors = std::array<const Descriptor*, axis_count>;

// Finds the descriptors of a variant's choices; a choice that the backend lacks has the other backend's descriptor.
Descriptors descriptors_of(const Variant& variant, Backend backend) {
    Descriptors descriptors{};
    for (std::size_t axis = 0; axis < axis_count; ++axis) {
        const std::string_view name = axis_names[axis];
        const Choice* choice = Registry::instance().find(name, variant[name], backend);
        for (const Backend other : all_backends) {
            choice = choice == nullptr ? Registry::instance().find(name, variant[name], other) : choice;
        }
        descriptors[axis] = choice == nullptr ? nullptr : &choice->descriptor;
    }
    return descriptors;
}

template <class AxisTraits>
Chosen<AxisTraits> chosen(std::string_view axis, const Descriptors& descriptors) {
    const Descriptor* const descriptor = descriptors[Variant::index(axis)];
    if (descriptor == nullptr) {
        return {};
    }
    return {traits_in<AxisTraits>(*descriptor), descriptor->name};
}

VariantTraits traits_of(const Descriptors& descriptors, const Variant& variant) {
    return {
#define PT_CHOSEN(name) .name = chosen<name::Traits>(#name, descriptors),
        PT_AXES(PT_CHOSEN)
#undef PT_CHOSEN
            .tuning = variant.tuning,
    };
}

// Finds the first of a variant's choices that does not go with the others or with the scene, and says why. Every choice
// must exist on the backend.
Reason reason_of_a_choice(const Descriptors& descriptors, const Variant& variant, FeatureSet scene) {
    const VariantTraits traits = traits_of(descriptors, variant);
    for (const Descriptor* const descriptor : descriptors) {
        Reason reason =
            descriptor->unsupported_reason == nullptr ? Reason{} : descriptor->unsupported_reason(scene, traits);
        if (!reason.empty()) {
            return {reason.code, label(*descriptor) + " " + reason.text, descriptor->axis};
        }
    }
    return {};
}

Reason reason_of_a_tunable(const Variant& variant, Backend backend) {
    const std::vector<Tunable> known = tunables_of(variant, backend);
    for (const auto& [name, value] : variant.tuning) {
        const auto position = std::find_if(known.begin(), known.end(),
                                           [&, &name = name](const Tunable& tunable) { return tunable.name == name; });
        if (position == known.end()) {
            return {"no_such_tunable", name + "=" + std::to_string(value) + " tunes none of the variant's choices"};
        }
        if (!position->allows(value)) {
            return {"tunable_out_of_range", name + "=" + std::to_string(value) + " is out of its range"};
        }
    }
    return {};
}

}  // namespace

Choice& Registry::insert(Backend backend, const Descriptor& descriptor) {
    Choices& choices = backends_[backend][Variant::index(descriptor.axis)];
    return choices.try_emplace(std::string(descriptor.name), Choice{descriptor, {}}).first->second;
}

void Registry::add(const Descriptor& descriptor, const Hook& hook) {
    check_descriptor(descriptor);
    for (const Backend backend : all_backends) {
        if (!contains(descriptor.backends, backend)) {
            continue;
        }
        if (find(descriptor.axis, descriptor.name, backend) != nullptr) {
            throw std::logic_error("choice registered twice: " + label(descriptor));
        }
        insert(backend, descriptor).hook = hook;
    }
}

void Registry::add_integrator(const Descriptor& descriptor, FeatureSet features, RenderFunction render) {
    check_descriptor(descriptor);
    insert(Backend::cpu, descriptor).hook.integrator[features] = render;
}

void Registry::add_integrator(const Descriptor& descriptor, FeatureSet features, RenderIn<double> render) {
    check_descriptor(descriptor);
    insert(Backend::cpu, descriptor).hook.integrator_in_double[features] = render;
}

std::vector<const Choice*> Registry::choices(std::string_view axis, Backend backend) const {
    std::vector<const Choice*> found;
    if (const auto axes = backends_.find(backend); axes != backends_.end()) {
        if (const std::size_t place = Variant::place(axis); place < axis_count) {
            for (const auto& [name, choice] : axes->second[place]) {
                found.push_back(&choice);
            }
        }
    }
    std::stable_partition(found.begin(), found.end(),
                          [=](const Choice* choice) { return contains(choice->descriptor.baseline, backend); });
    return found;
}

const Choice* Registry::find(std::string_view axis, std::string_view name, Backend backend) const {
    const auto axes = backends_.find(backend);
    const std::size_t place = Variant::place(axis);
    if (axes == backends_.end() || place == axis_count) {
        return nullptr;
    }
    // A linear search for a choice's name: an axis has few names, most of different lengths, so it beats std::map's,
    // and suites ask millions of times.
    for (const auto& [other, choice] : axes->second[place]) {
        if (other == name) {
            return &choice;
        }
    }
    return nullptr;
}

const Choice& Registry::at(std::string_view axis, const Variant& variant, Backend backend) const {
    const Choice* choice = find(axis, variant[axis], backend);
    if (choice == nullptr) {
        throw std::logic_error("no choice " + std::string(axis) + "=" + variant[axis] + " on " +
                               std::string(to_string(backend)));
    }
    return *choice;
}

Variant Registry::baseline(Backend backend) const {
    Variant variant;
    for (const std::string_view axis : axis_names) {
        variant.set(axis, std::string(choices(axis, backend).at(0)->descriptor.name));
    }
    return variant;
}

Variant Registry::reference(const Variant& variant, Backend backend) const {
    if (depends_on_order(variant, backend)) {
        return variant;
    }
    Variant reference = baseline(backend);
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = at(axis, variant, backend).descriptor;
        if (descriptor.claim != Claim::bitwise) {
            reference.set(axis, variant[axis]);
            for (const Tunable& tunable : descriptor.tunables) {
                if (const auto tuned = variant.tuning.find(tunable.name); tuned != variant.tuning.end()) {
                    reference.tuning.insert(*tuned);
                }
            }
            continue;
        }
        for (const Choice* choice : choices(axis, backend)) {
            if (contains(choice->descriptor.reference, backend)) {
                reference.set(axis, std::string(choice->descriptor.name));
            }
        }
        for (const Tunable& tunable : at(axis, reference, backend).descriptor.tunables) {
            if (tunable.is_shortcut) {
                reference.tuning.insert_or_assign(std::string(tunable.name), tunable.lowest);
            }
        }
    }
    return reference;
}

VariantTraits traits_of(const Variant& variant, Backend backend) {
    return traits_of(descriptors_of(variant, backend), variant);
}

Reason reason_not_applicable(const Variant& variant, FeatureSet scene, Backend backend) {
    Descriptors descriptors{};
    for (std::size_t place = 0; place < axis_count; ++place) {
        const std::string_view axis = axis_names[place];
        const Choice* const choice = Registry::instance().find(axis, variant[axis], backend);
        if (choice == nullptr) {
            return {"not_on_backend",
                    std::string(axis) + "=" + variant[axis] + " is not there on the backend " +
                        std::string(to_string(backend)),
                    axis};
        }
        descriptors[place] = &choice->descriptor;
    }
    Reason reason = reason_of_a_choice(descriptors, variant, scene);
    return reason.empty() ? reason_of_a_tunable(variant, backend) : reason;
}

std::string why_not_applicable(const Variant& variant, FeatureSet scene, Backend backend) {
    return reason_not_applicable(variant, scene, backend).text;
}

Claim claim_of(const Variant& variant, Backend backend) {
    Claim weakest = Claim::bitwise;
    for (const std::string_view axis : axis_names) {
        weakest = std::max(weakest, descriptor_at(axis, variant, backend).claim);
    }
    return weakest;
}

bool fp_relaxed(const Variant& variant, Backend backend) {
    return std::any_of(std::begin(axis_names), std::end(axis_names),
                       [&](std::string_view axis) { return descriptor_at(axis, variant, backend).fp_relaxed; });
}

Variant exact_twin(const Variant& variant, Backend backend) {
    Variant twin = variant;
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = descriptor_at(axis, variant, backend);
        if (descriptor.fp_relaxed) {
            twin.set(axis, std::string(descriptor.mean_of));
        }
    }
    return twin;
}

Variant variant_of_mean(const Variant& variant, Backend backend) {
    Variant plain = variant;
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = descriptor_at(axis, variant, backend);
        if (descriptor.claim == Claim::statistical) {
            plain.set(axis, std::string(descriptor.mean_of));
        }
    }
    return plain;
}

Variant with_every_feature(const Variant& variant, Backend backend) {
    const bool keeps_bits = descriptor_at(axes::specialisation, variant, backend).claim == Claim::bitwise &&
                            !depends_on_order(variant, backend);
    Variant complete = variant;
    for (const Choice* choice : Registry::instance().choices(axes::specialisation, backend)) {
        if (keeps_bits && traits_in<SpecialisationTraits>(choice->descriptor).is_generic) {
            complete.set(axes::specialisation, std::string(choice->descriptor.name));
        }
    }
    return complete == variant ? variant : without_foreign_tunables(complete, backend);
}

Variant without_foreign_tunables(Variant variant, Backend backend) {
    const std::vector<Tunable> known = tunables_of(variant, backend);
    std::erase_if(variant.tuning, [&](const auto& tuned) {
        return std::none_of(known.begin(), known.end(),
                            [&](const Tunable& tunable) { return tunable.name == tuned.first; });
    });
    return variant;
}

bool depends_on_order(const Variant& variant, Backend backend) {
    return std::any_of(std::begin(axis_names), std::end(axis_names),
                       [&](std::string_view axis) { return descriptor_at(axis, variant, backend).depends_on_order; });
}

bool has_independent_samples(const Variant& variant, Backend backend) {
    return std::all_of(std::begin(axis_names), std::end(axis_names), [&](std::string_view axis) {
        return descriptor_at(axis, variant, backend).has_independent_samples;
    });
}

std::uint32_t extra_depth(Variant variant, Backend backend) {
    std::uint32_t extra = 0;
    for (const std::string_view axis : axis_names) {
        while (descriptor_at(axis, variant, backend).claim == Claim::statistical) {
            extra += descriptor_at(axis, variant, backend).mean_at_extra_depth;
            variant.set(axis, std::string(descriptor_at(axis, variant, backend).mean_of));
        }
    }
    return extra;
}

FeatureSet features_asked(const Variant& variant, Backend backend) {
    FeatureSet asked = no_features;
    for (const std::string_view axis : axis_names) {
        if (const AddFeatures& features = Registry::instance().at(axis, variant, backend).hook.features) {
            asked |= features();
        }
    }
    return asked;
}

Tunable tunable_in(const Variant& variant, Tunable tunable, Backend backend) {
    const Choice* const choice =
        tunable.generic_value ? Registry::instance().find(axes::specialisation, variant[axes::specialisation], backend)
                              : nullptr;
    const SpecialisationTraits* const traits =
        choice == nullptr ? nullptr : std::get_if<SpecialisationTraits>(&choice->descriptor.traits);
    if (traits != nullptr && traits->is_generic) {
        tunable.default_value = *tunable.generic_value;
    }
    return tunable;
}

std::vector<Tunable> tunables_of(const Variant& variant, Backend backend) {
    std::vector<Tunable> all;
    for (const std::string_view axis : axis_names) {
        for (const Tunable& tunable : descriptor_at(axis, variant, backend).tunables) {
            all.push_back(tunable_in(variant, tunable, backend));
        }
    }
    return all;
}

std::vector<Tunable> all_tunables(Backend backend) {
    std::vector<Tunable> all;
    for (const std::string_view axis : axis_names) {
        for (const Choice* choice : Registry::instance().choices(axis, backend)) {
            for (const Tunable& tunable : choice->descriptor.tunables) {
                const bool known =
                    std::any_of(all.begin(), all.end(), [&](const Tunable& t) { return t.name == tunable.name; });
                if (!known) {
                    all.push_back(tunable);
                }
            }
        }
    }
    return all;
}

std::uint32_t tunable(const Variant& variant, std::string_view name, Backend backend) {
    if (const auto tuned = variant.tuning.find(name); tuned != variant.tuning.end()) {
        return tuned->second;
    }
    for (const Tunable& tunable : tunables_of(variant, backend)) {
        if (tunable.name == name) {
            return tunable.default_value;
        }
    }
    throw std::logic_error(shown_name(variant, backend) + " has no tunable " + std::string(name));
}

std::string check_counters(const Variant& variant, const WorkCounters& work, std::uint64_t samples, Backend backend) {
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = descriptor_at(axis, variant, backend);
        const std::string missing =
            descriptor.check_counters == nullptr ? "" : descriptor.check_counters(work, samples);
        if (!missing.empty()) {
            return label(descriptor) + ": " + missing;
        }
    }
    return "";
}

}  // namespace pt
