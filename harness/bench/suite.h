// Suites: what to run, and the cells that follow from it. A cell is scene x backend x variant x settings.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/bench/tuning.h"
#include "harness/error/reference.h"
#include "harness/render/renderer.h"

namespace pt {

// The choices asked for by axis; an axis that is not named stays at its baseline.
using AxisChoices = std::map<std::string, std::vector<std::string>>;

// Values by tunable; one that is not named stays at its standard.
using TunableValues = std::map<std::string, std::vector<std::uint32_t>>;

// A set of choices and tunable values that belong together, as part of a study.
struct VariantSet {
    AxisChoices axes;
    TunableValues tunables;
};

// The settings of a study of error against run time (harness/bench/convergence_study.h).
struct ConvergenceSettings {
    std::string reference_scene = {};  // whose image is the right one; empty: the cell's own scene
    std::map<std::string, std::string> reference_axes =
        {};                                      // choices of the reference's variant, where not the plainest
    double variance = 1e-6;                      // of the reference, a pixel and channel
    std::map<Backend, double> variance_on = {};  // where a backend has its own
    std::uint64_t most_spp = 65536;              // of each half of the reference
    std::map<Backend, std::uint64_t> most_spp_on = {};
    bool images = false;               // keep the first sample's image at every checkpoint
    bool without_checkpoints = false;  // the cells once more as ordinary ones
};

// What a study compares that asks how many paths are alive, bounce by bounce.
inline constexpr const char* live_paths = "live_paths";
// What a study's cells may be compared along: a setting, a scene's number of materials, or a tunable.
inline constexpr const char* along_depth = "depth";
inline constexpr const char* all_along[] = {"resolution", along_depth, "materials", "shading_fmas"};

struct Study {
    std::string name;
    std::string title;
    // The axis whose choices, or the tunable whose values, are held against each other, or live_paths. Empty: nothing,
    // or with `along` the first axis of which the study has several choices.
    std::string compares;
    std::string along = {};  // what else varies, so that the comparison is followed along it; empty: nothing
    std::vector<std::string> scenes;
    AxisChoices axes;
    TunableValues tunables;
    // Whether a call describes the study itself: what its axes leave open gets the best that is known (fastest.h). What
    // a suite leaves out is at its baseline.
    bool is_of_a_call = false;
    std::vector<VariantSet> variants = {};                // each is added to axes and tunables; empty: those
    std::optional<ConvergenceSettings> convergence = {};  // of a study of error against run time
    std::uint32_t width = 0, height = 0;                  // 0: the scene's own
    std::vector<std::pair<std::uint32_t, std::uint32_t>> more_sizes;  // resolutions besides width x height
    std::map<Backend, std::vector<std::pair<std::uint32_t, std::uint32_t>>> sizes_on =
        {};                             // where a backend has its own
    std::vector<std::uint32_t> depths;  // empty: the scene's own
    std::uint32_t spp = 1;
    std::vector<std::uint32_t> more_spp = {};      // besides spp
    std::map<Backend, std::uint32_t> spp_on = {};  // where a backend has its own

    std::vector<std::uint32_t> spps_for(Backend backend) const;
};

struct Suite {
    std::string name;
    std::string description;
    int repetitions = 9;
    int decide_seconds = 0;  // more samples for verdicts that are open by their interval's width, for so long; 0: none
    std::vector<Study> studies;
};

// The reference that a cell's images are compared with, and the numbers of samples at which they are.
struct CellConvergence {
    std::vector<std::uint32_t> checkpoints;
    ReferenceTask reference;
    bool images = false;
};

struct Cell {
    // The cell's name, VARIANT/scene:NAME/backend:NAME/resolution:WxH/depth:D/spp:N, and "/checkpoints:octaves" if it
    // has them.
    std::string name;
    std::vector<std::string> studies;
    std::shared_ptr<const Scene> scene;
    Backend backend = Backend::cpu;
    Variant variant;
    RenderSettings settings;
    std::uint32_t spp = 1;
    // Samples a pixel of the renders before the timed ones; 0: `spp`. Their films are compared with others' either way.
    std::uint32_t prepared_spp = 0;
    std::optional<CellConvergence> convergence = {};

    std::uint32_t samples_to_prepare() const { return prepared_spp != 0 ? prepared_spp : spp; }
};

struct NotApplicable {
    std::string study;
    std::string scene;
    Backend backend = Backend::cpu;
    Variant variant;
    Reason reason;
};

// What a cell's name says after its variant: "/scene:box/backend:cpu/800x800/depth:8/spp:1".
std::string setting_in(const std::string& cell_name);

struct Plan {
    std::vector<Cell> cells;  // each name once
    std::vector<NotApplicable> not_applicable;
    std::vector<std::string> chosen = {};  // what no call and no suite named, for people: "SCENE: accelerator=bvh8 ..."
};

// Loads a suite from its file, or from a text, for which `file` is for the messages. Throws InputError.
Suite load_suite(const std::string& file);
Suite parse_suite(const std::string& text, const std::string& file);
// Loads the scenes; throws InputError for an unknown scene, axis, choice or tunable. A choice that only another backend
// has is not applicable on this one.
// Variants get the values found for them by `tuning`, but for tunables that their study names.
Plan make_plan(const Suite& suite, Backend backend = Backend::cpu, const Tuning& tuning = {});

// Every variant that a study asks for, each once.
std::vector<Variant> variants_of(const Study& study, Backend backend = Backend::cpu);
// Every variant of the product of the given choices and values; unnamed axes at the backend's baseline. A value that is
// a tunable's standard is left out of the variant.
std::vector<Variant> expand(const AxisChoices& axes, Backend backend = Backend::cpu,
                            const TunableValues& tunables = {});
// Every choice of every axis on a backend.
AxisChoices all_choices(Backend backend = Backend::cpu);
// A pairwise covering: variants that apply to a scene with these features, in which every compatible pair of choices of
// two axes occurs. All combinations of choices would be too many.
std::vector<Variant> covering_variants(const AxisChoices& axes, FeatureSet features, Backend backend);
// As few variants of several scenes' coverings as have every choice that occurs in any of them, shared evenly among the
// scenes.
std::vector<std::vector<Variant>> each_choice_once(std::vector<std::vector<Variant>> coverings);
// "NAME=c1,c2" -> adds to `axes`; throws InputError, with the allowed names, for an unknown name and for an axis that
// `axes` has already. "NAME=all": all choices of the backend.
void add_axis_argument(AxisChoices& axes, const std::string& argument, Backend backend = Backend::cpu);
AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, Backend backend = Backend::cpu);
// Reads axis arguments and the choices of the axis `devices` as --devices lists them; empty: none.
AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, const std::string& devices,
                                 Backend backend);
// "NAME=v1,v2" -> adds to `tunables`; throws InputError, with what is allowed, for a value that is not and for a name
// that `tunables` has already.
void add_tunable_argument(TunableValues& tunables, const std::string& argument);
TunableValues parse_tunable_arguments(const std::vector<std::string>& arguments);
// Throws InputError if no choice on any backend has such a tunable, or none that has it allows the value.
void check_tunable(const std::string& name, std::uint32_t value, const std::string& file, const std::string& place);
// Whether a build without a CUDA toolkit has to let the name pass: it does not know that backend's tunables, and a
// suite that names them is good there too.
bool may_be_known_elsewhere(const std::string& name);
void check_choices(const AxisChoices& axes, const std::string& file, const std::string& place);

}  // namespace pt
