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

// The requested choices by axis; an axis that is not named stays at its baseline.
using AxisChoices = std::map<std::string, std::vector<std::string>>;

// The requested values by tunable; a tunable that is not named stays at its standard value.
using TunableValues = std::map<std::string, std::vector<std::uint32_t>>;

// A set of choices and tunable values that belong together, as part of a study.
struct VariantSet {
    AxisChoices axes;
    TunableValues tunables;
};

// The settings of a study of error against run time (harness/bench/convergence_study.h).
struct ConvergenceSettings {
    std::string reference_scene = {};                        // scene of the reference image; empty: that of the cell
    std::map<std::string, std::string> reference_axes = {};  // choices of the variant that renders the reference
    double variance = 1e-6;                                  // largest variance of the reference image per channel
    std::map<Backend, double> variance_on = {};              // largest variance of the reference, for single backends
    std::uint64_t most_spp = 65536;                          // largest spp of each half of the reference
    std::map<Backend, std::uint64_t> most_spp_on = {};
    bool images = false;               // whether to save the first sample's image at each checkpoint
    bool without_checkpoints = false;  // whether to time the cells without checkpoints too
};

// The value of `compares` for a study of how many paths are alive at each bounce.
inline constexpr const char* live_paths = "live_paths";
// The values of `along`, a comparison's second parameter: a setting, a scene's number of materials, or a tunable.
inline constexpr const char* along_depth = "depth";
inline constexpr const char* all_along[] = {"resolution", along_depth, "materials", "shading_fmas"};

struct Study {
    std::string name;
    std::string title;
    // The axis or the tunable that the study compares, or live_paths. If empty, the study compares nothing or, with
    // `along`, the first axis on which its cells have several choices.
    std::string compares;
    std::string along = {};  // second parameter that varies in the study; empty: none
    std::vector<std::string> scenes;
    AxisChoices axes;
    TunableValues tunables;
    // Whether a command line describes the study. Axes that it leaves open get the best known choice (fastest.h), those
    // that a suite leaves open their baseline.
    bool is_of_a_call = false;
    std::vector<VariantSet> variants = {};                // choices and values to combine with `axes` and `tunables`
    std::optional<ConvergenceSettings> convergence = {};  // settings of a study of error against time; else none
    std::uint32_t width = 0, height = 0;                  // resolution in pixels; 0: the scene's own
    std::vector<std::pair<std::uint32_t, std::uint32_t>> more_sizes;  // resolutions besides width x height
    std::map<Backend, std::vector<std::pair<std::uint32_t, std::uint32_t>>> sizes_on =
        {};                             // resolutions for single backends
    std::vector<std::uint32_t> depths;  // limits of path depth; empty: the scene's own
    std::uint32_t spp = 1;
    std::vector<std::uint32_t> more_spp = {};      // samples per pixel besides `spp`
    std::map<Backend, std::uint32_t> spp_on = {};  // samples per pixel for single backends

    std::vector<std::uint32_t> spps_for(Backend backend) const;
};

struct Suite {
    std::string name;
    std::string description;
    int repetitions = 9;
    int decide_seconds = 0;  // time limit for further samples of cells whose verdict is open; 0: none
    std::vector<Study> studies;
};

// The reference image of a cell, and the sample counts at which the cell's film is compared with it.
struct CellConvergence {
    std::vector<std::uint32_t> checkpoints;
    ReferenceTask reference;
    bool images = false;
};

struct Cell {
    // The cell's full name, VARIANT/scene:NAME/backend:NAME/resolution:WxH/depth:D/spp:N, followed by
    // "/checkpoints:octaves" for a cell with checkpoints.
    std::string name;
    std::vector<std::string> studies;
    std::shared_ptr<const Scene> scene;
    Backend backend = Backend::cpu;
    Variant variant;
    RenderSettings settings;
    std::uint32_t spp = 1;
    // Samples per pixel of the renders that prepare the cell (verification, instrumented pass); 0: `spp`.
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

// The part of a cell's name behind the variant: "/scene:box/backend:cpu/800x800/depth:8/spp:1".
std::string setting_in(const std::string& cell_name);

struct Plan {
    std::vector<Cell> cells;  // cells in the order of the studies, with unique names
    std::vector<NotApplicable> not_applicable;
    std::vector<std::string> chosen = {};  // choices made automatically, "SCENE: accelerator=bvh8 ..."
};

// Loads a suite from its file, or from a text; `file` then only stands in error messages. Throws InputError.
Suite load_suite(const std::string& file);
Suite parse_suite(const std::string& text, const std::string& file);
// Makes the plan of a suite and loads its scenes. A choice that exists on another backend only does not apply. Variants
// get the tuned values in `tuning`, except for tunables that their study names. Throws InputError for an unknown scene,
// axis, choice or tunable.
Plan make_plan(const Suite& suite, Backend backend = Backend::cpu, const Tuning& tuning = {});

// Every distinct variant that a study asks for.
std::vector<Variant> variants_of(const Study& study, Backend backend = Backend::cpu);
// The product of all given choices and values as variants; axes that are not named stay at the backend's baseline. A
// tunable's standard value is left out of the variant.
std::vector<Variant> expand(const AxisChoices& axes, Backend backend = Backend::cpu,
                            const TunableValues& tunables = {});
AxisChoices all_choices(Backend backend = Backend::cpu);
// A pairwise covering: variants that apply to a scene with these features and together contain every compatible pair of
// choices on two axes. All combinations of choices would be too many.
std::vector<Variant> covering_variants(const AxisChoices& axes, FeatureSet features, Backend backend);
// Selects few variants from the coverings of several scenes, in turns over the scenes, so that every choice that occurs
// in any covering occurs in a selected variant.
std::vector<std::vector<Variant>> each_choice_once(std::vector<std::vector<Variant>> coverings);
// Parses the argument "AXIS=c1,c2" or "AXIS=all" (all choices of the backend) and adds the choices to `axes`. Throws
// InputError for an unknown name, with the allowed names, and for an axis that `axes` already has.
void add_axis_argument(AxisChoices& axes, const std::string& argument, Backend backend = Backend::cpu);
AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, Backend backend = Backend::cpu);
// Parses axis arguments, and the value of --devices as choices of the axis `devices`, unless it is empty.
AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, const std::string& devices,
                                 Backend backend);
// Parses "NAME=v1,v2" and adds it to `tunables`. Throws InputError for a value that is not allowed, with the allowed
// values, and for a name that `tunables` already has.
void add_tunable_argument(TunableValues& tunables, const std::string& argument);
TunableValues parse_tunable_arguments(const std::vector<std::string>& arguments);
// Throws InputError if no choice on any backend has this tunable, or none that has it allows the value.
void check_tunable(const std::string& name, std::uint32_t value, const std::string& file, const std::string& place);
// Whether an unknown tunable must be accepted because this build has no CUDA backend: a suite may name CUDA's tunables.
bool may_be_known_elsewhere(const std::string& name);
void check_choices(const AxisChoices& axes, const std::string& file, const std::string& place);

}  // namespace pt
