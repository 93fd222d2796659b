// The registry of choices: choices register themselves in it, and the harness finds them by it. A choice's file defines
// one namespace-scope `Registration`; nothing else in the program names the choice.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "variants/bvh/hooks.h"
#include "variants/cuda_hooks.h"
#include "variants/descriptor.h"
#include "variants/render_job.h"

namespace pt {

using MakeCompaction = std::function<std::unique_ptr<Compaction>()>;
using MakeSorting = std::function<std::unique_ptr<Sorting>()>;
// Returns how many camera rays of a pixel have their first hits cached; 0: none.
using KeepCameraRays = std::function<std::uint32_t(const Variant& variant, Backend backend)>;
using MakePaths = std::function<AnyPaths()>;
template <class Real>
using RenderIn = void (*)(RenderJobIn<Real>&);
using RenderFunction = RenderIn<float>;
// Returns the features that a choice adds to those of the scene.
using AddFeatures = std::function<FeatureSet()>;
// What a choice of the axis `specialisation` picks a kernel's feature set from.
struct KernelOffer {
    FeatureSet needed = no_features;     // features that the scene and the variant need from the kernel
    FeatureSet shortcuts = no_features;  // shortcut features that the scene allows
    std::vector<FeatureSet> compiled;    // feature sets that the integrator is compiled for, or can be
};
// Picks, for a choice of the axis `specialisation`, the feature set of the kernel to run.
using ChooseFeatures = std::function<FeatureSet(const KernelOffer& offer, const Variant& variant, Backend backend)>;

// The code that a choice brings: `features`, and at most one other member, which the choice's axis and backend decide.
// A choice that is only a name (`none`, a compiler option) brings none.
struct Hook {
    MakeCompaction compaction = {};
    MakeSorting sorting = {};
    KeepCameraRays first_bounce = {};
    MakePaths layout = {};
    AddFeatures features = {};
    ChooseFeatures specialisation = {};
    std::map<FeatureSet, RenderFunction> integrator = {};
    std::map<FeatureSet, RenderIn<double>> integrator_in_double = {};  // empty: the integrator has none in double
    AcceleratorHook accelerator = {};
    BuilderHook builder = {};
    LevelsHook levels = {};
    cuda::Hooks cuda = {};
};

struct Choice {
    Descriptor descriptor;
    Hook hook;
};

class Registry {
public:
    static Registry& instance();

    // Adds a choice on every backend that its descriptor names. Throws std::logic_error if the axis is unknown or if a
    // backend already has a choice of this name on the axis.
    void add(const Descriptor& descriptor, const Hook& hook);
    // A CPU integrator is registered once for each feature set and each precision that it has been compiled for.
    void add_integrator(const Descriptor& descriptor, FeatureSet features, RenderFunction render);
    void add_integrator(const Descriptor& descriptor, FeatureSet features, RenderIn<double> render);

    // The choices of an axis: the baseline first, the others by name.
    std::vector<const Choice*> choices(std::string_view axis, Backend backend = Backend::cpu) const;
    // Finds a choice of an axis; null if none has this name.
    const Choice* find(std::string_view axis, std::string_view name, Backend backend = Backend::cpu) const;
    const Choice& at(std::string_view axis, const Variant& variant, Backend backend = Backend::cpu) const;

    // The variant with every axis at its baseline.
    Variant baseline(Backend backend = Backend::cpu) const;
    // The variant whose film must equal the film of `variant` bit for bit. Axes on which `variant` has a bitwise choice
    // get the plainest choice (Descriptor::reference, else the baseline), default tunables and no shortcuts
    // (Tunable::is_shortcut); other axes stay. A variant whose film depends on the queue's order is its own reference.
    Variant reference(const Variant& variant, Backend backend = Backend::cpu) const;

private:
    using Choices = std::map<std::string, Choice, std::less<>>;
    using Axes = std::array<Choices, axis_count>;  // the choices of every axis, in the order of axis_table
    Choice& insert(Backend backend, const Descriptor& descriptor);

    std::map<Backend, Axes> backends_;
};

struct Registration {
    Registration(const Descriptor& descriptor, const Hook& hook) { Registry::instance().add(descriptor, hook); }
};

struct IntegratorRegistration {
    template <class Real>
    IntegratorRegistration(const Descriptor& descriptor, FeatureSet features, RenderIn<Real> render) {
        Registry::instance().add_integrator(descriptor, features, render);
    }
};

// The traits of a variant's choices. A choice that this backend lacks has the traits that it has on the other backend.
VariantTraits traits_of(const Variant& variant, Backend backend);

// Why a variant cannot run on a scene with these features ("axis=choice reason"); empty if it can. A choice that the
// backend lacks and a tunable that none of the choices has are reasons, too.
Reason reason_not_applicable(const Variant& variant, FeatureSet scene, Backend backend = Backend::cpu);
// The text of reason_not_applicable, which says why the variant cannot run; empty: it can.
std::string why_not_applicable(const Variant& variant, FeatureSet scene, Backend backend = Backend::cpu);

// The weakest claim (bitwise, then statistical, then biased) among the variant's choices.
Claim claim_of(const Variant& variant, Backend backend = Backend::cpu);

// Whether the compiler may round the variant's arithmetic as it likes (Descriptor::fp_relaxed).
bool fp_relaxed(const Variant& variant, Backend backend);
// The variant with each choice that rounds freely (fp_relaxed) replaced by the choice whose mean it claims.
Variant exact_twin(const Variant& variant, Backend backend);
// The variant with each choice of a statistical claim replaced by the one whose mean it claims.
Variant variant_of_mean(const Variant& variant, Backend backend);
// The variant with the same film whose kernel has every feature and is compiled once for all scenes. A variant is
// returned unchanged if its film depends on its specialisation (matrix) or on the order of its queue.
Variant with_every_feature(const Variant& variant, Backend backend);
// The variant without the tunables that none of the variant's choices has.
Variant without_foreign_tunables(Variant variant, Backend backend);

// Whether one of the variant's choices depends on the order of the queue, and whether all its choices have independent
// samples (the flags of the same names in Descriptor).
bool depends_on_order(const Variant& variant, Backend backend);
bool has_independent_samples(const Variant& variant, Backend backend);
// How many segments deeper than a variant the last of its chain of claims must trace: the sum of mean_at_extra_depth
// (Descriptor). Claims form chains, since a choice may claim the mean of one that claims the mean of a third.
std::uint32_t extra_depth(Variant variant, Backend backend);
// The features that the variant's choices ask of a kernel, whatever the scene.
FeatureSet features_asked(const Variant& variant, Backend backend);

// A tunable of a variant with the default value that is meant for the variant's kernel (Tunable::generic_value).
Tunable tunable_in(const Variant& variant, Tunable tunable, Backend backend);
// The tunables that the variant's choices have, those of the integrator first.
std::vector<Tunable> tunables_of(const Variant& variant, Backend backend);
// Every tunable that some choice of the backend has; each name is listed once.
std::vector<Tunable> all_tunables(Backend backend);
// The value of a tunable in a variant. Throws std::logic_error if none of the variant's choices has the tunable.
std::uint32_t tunable(const Variant& variant, std::string_view name, Backend backend);

// What the choices of a variant left undone in a render of `samples` samples a pixel; empty: all did their work.
std::string check_counters(const Variant& variant, const WorkCounters& work, std::uint64_t samples,
                           Backend backend = Backend::cpu);

}  // namespace pt
