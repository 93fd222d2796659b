// Where choices register themselves, and where the harness finds them. A choice's file defines one namespace-scope
// `Registration`; nothing else in the program names the choice.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "variants/descriptor.h"
#include "variants/render_job.h"

namespace pt {

using MakeCompaction = std::function<std::unique_ptr<Compaction>()>;
using MakeSorting = std::function<std::unique_ptr<Sorting>()>;
using MakeFirstBounceCache = std::function<std::unique_ptr<FirstBounceCache>(std::uint32_t pixels)>;  // may return null
using MakePaths = std::function<AnyPaths()>;
using RenderFunction = void (*)(RenderJob&);
// The features that a direct-light choice adds to those of the scene.
using AddFeatures = std::function<FeatureSet()>;
// Picks, from the feature sets that an integrator was compiled for, the one to run for a scene that needs `needed`.
using ChooseFeatures = std::function<FeatureSet(FeatureSet needed, const std::vector<FeatureSet>& compiled)>;

// What a choice brings; exactly one member is set, by its axis.
struct Hook {
    MakeCompaction compaction = {};
    MakeSorting sorting = {};
    MakeFirstBounceCache first_bounce = {};
    MakePaths layout = {};
    AddFeatures direct_light = {};
    ChooseFeatures specialisation = {};
    std::map<FeatureSet, RenderFunction> integrator = {};
};

struct Choice {
    Descriptor descriptor;
    Hook hook;
};

class Registry {
public:
    static Registry& instance();

    // Throws std::logic_error if the axis is unknown or already has a choice of this name.
    void add(const Descriptor& descriptor, Hook hook);
    // An integrator is registered once for each feature set that it was compiled for.
    void add_integrator(const Descriptor& descriptor, FeatureSet features, RenderFunction render);

    // The choices of an axis: its baseline first, then by name.
    std::vector<const Choice*> choices(std::string_view axis) const;
    // Null if there is none of this name.
    const Choice* find(std::string_view axis, std::string_view name) const;
    const Choice& at(std::string_view axis, const Variant& variant) const;

    // Every axis at its baseline.
    Variant baseline() const;
    // The variant that `variant` must equal bit for bit: every axis whose choices claim `bitwise` goes to the plainest
    // choice (Descriptor::reference, else the baseline), the others stay.
    Variant reference(const Variant& variant) const;

private:
    std::map<std::string, std::map<std::string, Choice>> axes_;
};

struct Registration {
    Registration(const Descriptor& descriptor, Hook hook) { Registry::instance().add(descriptor, std::move(hook)); }
};

struct IntegratorRegistration {
    IntegratorRegistration(const Descriptor& descriptor, FeatureSet features, RenderFunction render) {
        Registry::instance().add_integrator(descriptor, features, render);
    }
};

// Why a variant cannot run on a scene with these features ("axis=choice reason"); empty: it can.
std::string why_not_applicable(const Variant& variant, FeatureSet scene);

// The weakest claim among the variant's choices.
Claim claim_of(const Variant& variant);

// What the choices of a variant left undone in a render of `samples` samples a pixel; empty: all did their work.
std::string work_missing(const Variant& variant, const WorkCounters& work, std::uint64_t samples);

}  // namespace pt
