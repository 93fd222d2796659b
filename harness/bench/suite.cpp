#include "harness/bench/suite.h"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "choices_not_built.h"  // generated
#include "harness/bench/convergence_study.h"
#include "harness/bench/fastest.h"
#include "harness/json_reader.h"
#include "harness/nearest_name.h"
#include "harness/scene/places.h"
#include "harness/words.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// The distinct choices of an axis on all backends, including choices that this build leaves out.
std::vector<std::string> names_on_any_backend(std::string_view axis) {
    std::set<std::string> names;
    for (const Backend backend : all_backends) {
        for (const Choice* choice : Registry::instance().choices(axis, backend)) {
            names.emplace(choice->descriptor.name);
        }
    }
    for (const auto& [other_axis, name] : choices_not_built) {
        if (other_axis == axis) {
            names.emplace(name);
        }
    }
    return {names.begin(), names.end()};
}

// The tunables of all choices on all backends; a tunable that several choices have occurs several times.
std::vector<Tunable> tunables_on_any_backend() {
    std::vector<Tunable> all;
    for (const Backend backend : all_backends) {
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                const std::span<const Tunable> tunables = choice->descriptor.tunables;
                all.insert(all.end(), tunables.begin(), tunables.end());
            }
        }
    }
    return all;
}

std::vector<std::string> names_of(const std::vector<const Choice*>& choices) {
    std::vector<std::string> names;
    for (const Choice* choice : choices) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

// The resolutions of a study; {0, 0} stands for the scene's own.
std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_of(const Study& study, Backend backend) {
    if (const auto own = study.sizes_on.find(backend); own != study.sizes_on.end()) {
        return own->second;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes{{study.width, study.height}};
    sizes.insert(sizes.end(), study.more_sizes.begin(), study.more_sizes.end());
    return sizes;
}

Cell make_cell(const std::shared_ptr<const Scene>& scene, Backend backend, const Variant& variant, std::uint32_t width,
               std::uint32_t height, std::uint32_t depth, std::uint32_t spp) {
    Cell cell;
    cell.scene = scene;
    cell.backend = backend;
    cell.variant = variant;
    cell.settings = default_settings(*scene);
    if (width != 0) {
        cell.settings.width = width;
        cell.settings.height = height;
    }
    cell.settings.depth = depth;
    cell.spp = spp;
    cell.name =
        fmt::format("{}/scene:{}/backend:{}/{}x{}/depth:{}/spp:{}", benchmark_name(variant, backend), scene->name,
                    to_string(backend), cell.settings.width, cell.settings.height, depth, cell.spp);
    return cell;
}

// Merges two studies' requests for the same cell; the reference image gets the higher of the two accuracies.
void merge(Cell& known, const Cell& other, const std::string& study) {
    known.prepared_spp =
        known.samples_to_prepare() >= other.samples_to_prepare() ? known.prepared_spp : other.prepared_spp;
    if (!known.convergence) {
        return;
    }
    CellConvergence& kept = *known.convergence;
    const CellConvergence& added = *other.convergence;
    if (kept.reference.name() != added.reference.name()) {
        throw InputError(fmt::format("study {}: {} is compared with {} there and with {} elsewhere in the suite", study,
                                     known.name, added.reference.name(), kept.reference.name()));
    }
    kept.reference.variance = std::min(kept.reference.variance, added.reference.variance);
    kept.reference.most_spp = std::max(kept.reference.most_spp, added.reference.most_spp);
    kept.images = kept.images || added.images;
}

using Scenes = std::map<std::string, std::shared_ptr<const Scene>>;  // loaded scenes by name or file

// Loads each scene that a suite names once.
Scenes scenes_of(const Suite& suite) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) {
            names.push_back(name);
        }
    };
    for (const Study& study : suite.studies) {
        std::for_each(study.scenes.begin(), study.scenes.end(), add);
        add(study.convergence ? study.convergence->reference_scene : "");
    }
    std::vector<Scene> loaded = find_scenes(names);
    Scenes scenes;
    for (std::size_t i = 0; i < names.size(); ++i) {
        scenes[names[i]] = std::make_shared<const Scene>(std::move(loaded[i]));
    }
    return scenes;
}

}  // namespace

std::string setting_in(const std::string& cell_name) {
    return cell_name.substr(std::min(cell_name.find("/scene:"), cell_name.size()));
}

bool may_be_known_elsewhere(const std::string& name) {
    const std::vector<Tunable> known = tunables_on_any_backend();
    return !choices_not_built.empty() &&
           std::none_of(known.begin(), known.end(), [&](const Tunable& tunable) { return tunable.name == name; });
}

void check_choices(const AxisChoices& axes, const std::string& file, const std::string& place) {
    for (const auto& [axis, names] : axes) {
        if (std::find(std::begin(axis_names), std::end(axis_names), axis) == std::end(axis_names)) {
            throw InputError(file, place, "axis \"" + axis + "\"",
                             fmt::format("{}{}", fmt::join(axis_names, ", "),
                                         did_you_mean(axis, {std::begin(axis_names), std::end(axis_names)})));
        }
        const std::vector<std::string> known = names_on_any_backend(axis);
        for (const std::string& name : names) {
            if (std::find(known.begin(), known.end(), name) == known.end()) {
                throw InputError(file, place + "." + axis, "\"" + name + "\"",
                                 fmt::format("{}{}", fmt::join(known, ", "), did_you_mean(name, known)));
            }
        }
    }
}

namespace {

// Adds choices to an axis in `axes`. `list` holds names of choices separated by commas, or is "all".
void add_choices(AxisChoices& axes, const std::string& axis, const std::string& list, const char* option,
                 Backend backend) {
    std::vector<std::string> names;
    for (const std::string& name : split_at_commas(list)) {
        names.push_back(name);
        check_once(names, option, "argument." + axis);
    }
    if (names == std::vector<std::string>{"all"}) {
        check_choices({{axis, {}}}, option, "argument");
        names = names_of(Registry::instance().choices(axis, backend));
    }
    check_choices({{axis, names}}, option, "argument");
    if (!axes.try_emplace(axis, names).second) {
        throw InputError(option, "argument", axis + " twice", "once, with commas between its choices");
    }
}

}  // namespace

void add_axis_argument(AxisChoices& axes, const std::string& argument, Backend backend) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == argument.size()) {
        throw InputError("--axis", "argument", "\"" + argument + "\"", "NAME=CHOICE or NAME=CHOICE,CHOICE");
    }
    add_choices(axes, argument.substr(0, equals), argument.substr(equals + 1), "--axis", backend);
}

AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, Backend backend) {
    AxisChoices axes;
    for (const std::string& argument : arguments) {
        add_axis_argument(axes, argument, backend);
    }
    return axes;
}

AxisChoices parse_axis_arguments(const std::vector<std::string>& arguments, const std::string& devices,
                                 Backend backend) {
    AxisChoices axes = parse_axis_arguments(arguments, backend);
    if (!devices.empty()) {
        add_choices(axes, axes::devices, devices, "--devices", backend);
    }
    return axes;
}

// Throws InputError unless a choice has a tunable of this name that allows the value. Variants whose own choice does
// not allow it do not apply.
void check_tunable(const std::string& name, std::uint32_t value, const std::string& file, const std::string& place) {
    std::set<std::string> known, ranges;
    for (const Tunable& tunable : tunables_on_any_backend()) {
        known.emplace(tunable.name);
        if (tunable.name != name) {
            continue;
        }
        if (tunable.allows(value)) {
            return;
        }
        ranges.insert(
            fmt::format("a whole number from {} to {}{}", tunable.lowest, tunable.highest,
                        tunable.multiple_of > 1 ? fmt::format(", a multiple of {}", tunable.multiple_of) : ""));
    }
    if (!known.contains(name)) {
        throw InputError(file, place, "tunable \"" + name + "\"",
                         fmt::format("{}{}", fmt::join(known, ", "), did_you_mean(name, {known.begin(), known.end()})));
    }
    throw InputError(file, place, std::to_string(value), fmt::format("{}", fmt::join(ranges, ", or ")));
}

void add_tunable_argument(TunableValues& tunables, const std::string& argument) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == argument.size()) {
        throw InputError("--tune", "argument", "\"" + argument + "\"", "NAME=VALUE or NAME=VALUE,VALUE");
    }
    const std::string name = argument.substr(0, equals);
    std::vector<std::uint32_t> values;
    for (const std::string& word : split_at_commas(argument.substr(equals + 1))) {
        const auto value = parse_number<std::uint32_t>(word);
        if (!value) {
            throw InputError("--tune", "argument." + name, "\"" + argument + "\"", "whole numbers, comma-separated");
        }
        check_tunable(name, *value, "--tune", "argument." + name);
        values.push_back(*value);
        check_once(values, "--tune", "argument." + name);
    }
    if (!tunables.try_emplace(name, values).second) {
        throw InputError("--tune", "argument", name + " twice", "once, with commas between its values");
    }
}

TunableValues parse_tunable_arguments(const std::vector<std::string>& arguments) {
    TunableValues tunables;
    for (const std::string& argument : arguments) {
        add_tunable_argument(tunables, argument);
    }
    return tunables;
}

AxisChoices all_choices(Backend backend) {
    AxisChoices all;
    for (const std::string_view axis : axis_names) {
        all[std::string(axis)] = names_of(Registry::instance().choices(axis, backend));
    }
    return all;
}

namespace {

// The value of a tunable in a variant that does not name it: the standard of the variant's choice that has the tunable
// (choices of an axis may differ), or of the backend's first choice that has it. None if there is no such choice.
std::optional<std::uint32_t> default_value_of(const Variant& variant, const std::string& name, Backend backend) {
    std::vector<Tunable> tunables;
    for (const std::string_view axis : axis_names) {
        if (const Choice* choice = Registry::instance().find(axis, variant[axis], backend); choice != nullptr) {
            tunables.insert(tunables.end(), choice->descriptor.tunables.begin(), choice->descriptor.tunables.end());
        }
    }
    const std::vector<Tunable> others = all_tunables(backend);
    tunables.insert(tunables.end(), others.begin(), others.end());
    const auto position =
        std::find_if(tunables.begin(), tunables.end(), [&](const Tunable& tunable) { return tunable.name == name; });
    return position != tunables.end() ? std::optional(tunable_in(variant, *position, backend).default_value)
                                      : std::nullopt;
}

// Combines every variant with every value of a tunable. The standard value is left out, so that a variant has one name.
std::vector<Variant> with_values(const std::vector<Variant>& variants, const std::string& name,
                                 const std::vector<std::uint32_t>& values, Backend backend) {
    std::vector<Variant> next;
    for (const Variant& variant : variants) {
        const std::optional<std::uint32_t> default_value = default_value_of(variant, name, backend);
        for (const std::uint32_t value : values) {
            next.push_back(variant);
            if (default_value != value) {
                next.back().tuning[name] = value;
            }
        }
    }
    return next;
}

}  // namespace

std::vector<Variant> expand(const AxisChoices& axes, Backend backend, const TunableValues& tunables) {
    std::vector<Variant> variants{Registry::instance().baseline(backend)};
    for (const std::string_view axis : axis_names) {
        const auto position = axes.find(std::string(axis));
        if (position == axes.end()) {
            continue;
        }
        std::vector<Variant> next;
        for (const Variant& variant : variants) {
            for (const std::string& choice : position->second) {
                next.push_back(variant);
                next.back().set(axis, choice);
            }
        }
        variants = std::move(next);
    }
    for (const auto& [name, values] : tunables) {
        variants = with_values(variants, name, values, backend);
    }
    return variants;
}

std::vector<Variant> variants_of(const Study& study, Backend backend) {
    if (study.variants.empty()) {
        return expand(study.axes, backend, study.tunables);
    }
    std::vector<Variant> variants;
    std::set<Variant> known;
    for (VariantSet set : study.variants) {
        set.axes.insert(study.axes.begin(), study.axes.end());
        set.tunables.insert(study.tunables.begin(), study.tunables.end());
        for (Variant& variant : expand(set.axes, backend, set.tunables)) {
            if (known.insert(variant).second) {
                variants.push_back(std::move(variant));
            }
        }
    }
    return variants;
}

std::vector<std::uint32_t> Study::spps_for(Backend backend) const {
    if (const auto own = spp_on.find(backend); own != spp_on.end()) {
        return {own->second};
    }
    std::vector<std::uint32_t> spps{spp};
    spps.insert(spps.end(), more_spp.begin(), more_spp.end());
    return spps;
}

namespace {

std::set<std::string> named_tunables(const Study& study) {
    std::set<std::string> named;
    for (const auto& [tunable, values] : study.tunables) {
        named.insert(tunable);
    }
    for (const VariantSet& set : study.variants) {
        for (const auto& [tunable, values] : set.tunables) {
            named.insert(tunable);
        }
    }
    return named;
}

void check_reference(const ReferenceTask& task, const std::string& study) {
    const Variant variant = reference_variant(task);
    if (const std::string reason = why_not_applicable(variant, features_of(*task.scene), task.backend);
        !reason.empty()) {
        throw InputError(fmt::format("study {}: its reference {} cannot be rendered on {}: {}", study,
                                     shown_name(variant, task.backend), to_string(task.backend), reason));
    }
}

// Makes the plan of a suite, in which each cell occurs once.
class PlanMaker {
public:
    PlanMaker(const Suite& suite, Backend backend, const Tuning& tuning)
        : suite_(suite), backend_(backend), tuning_(tuning), scenes_(scenes_of(suite)) {}

    Plan make() {
        for (const Study& study : suite_.studies) {
            const std::set<std::string> named = named_tunables(study);
            const std::vector<Variant> variants = variants_of(study, backend_);
            for (const std::string& name : study.scenes) {
                const std::shared_ptr<const Scene>& scene = scenes_.at(name);
                for (const Variant& asked : study.is_of_a_call ? best_known(study, *scene) : variants) {
                    add_variant(study, scene, tuning_.applied(asked, named));
                }
            }
        }
        return std::move(plan_);
    }

private:
    // The study's variants, with the best known choices on axes that the command left open (listed in plan_.chosen).
    std::vector<Variant> best_known(Study study, const Scene& scene) {
        const std::string tree = tree_in_words(study.axes, study.tunables, scene, backend_);
        if (!tree.empty()) {
            plan_.chosen.push_back(fmt::format("{}: {}", scene.name, tree));
        }
        study.axes = with_tree(study.axes, study.tunables, scene, backend_);
        std::vector<Variant> variants = variants_of(study, backend_);
        std::set<std::string> added;
        for (Variant& variant : variants) {
            variant = with_light_sampling(variant, study.axes, features_of(scene), backend_);
            added.insert(light_sampling_in_words(variant, study.axes));
        }
        for (const std::string& words : added) {
            if (!words.empty()) {
                plan_.chosen.push_back(fmt::format("{}: {}", scene.name, words));
            }
        }
        return variants;
    }

    // Adds the cells of a variant, for every resolution, depth and number of samples.
    void add_variant(const Study& study, const std::shared_ptr<const Scene>& scene, const Variant& variant) {
        if (Reason reason = reason_not_applicable(variant, features_of(*scene), backend_); !reason.empty()) {
            plan_.not_applicable.push_back({study.name, scene->name, backend_, variant, std::move(reason)});
            return;
        }
        const std::vector<std::uint32_t> depths =
            study.depths.empty() ? std::vector<std::uint32_t>{scene->max_depth} : study.depths;
        for (const auto& [width, height] : sizes_of(study, backend_)) {
            for (const std::uint32_t depth : depths) {
                for (const std::uint32_t spp : study.spps_for(backend_)) {
                    const Cell cell = make_cell(scene, backend_, variant, width, height, depth, spp);
                    study.convergence ? add_cells_with_error(study, cell) : add_cell(cell, study.name);
                }
            }
        }
    }

    // Adds a cell with checkpoints, at the depth at which its variant has the expectation of plain paths of the
    // requested depth. If the study wants it, the cell without checkpoints is added too.
    void add_cells_with_error(const Study& study, const Cell& asked) {
        const ConvergenceSettings& settings = *study.convergence;
        const std::uint32_t depth = asked.settings.depth;
        const std::uint32_t own_depth = depth_for_mean_of(asked.variant, backend_, depth);
        if (own_depth == 0) {
            Reason reason{"no_such_depth", fmt::format("has no depth at which its mean is that of {}", depth)};
            plan_.not_applicable.push_back({study.name, asked.scene->name, backend_, asked.variant, std::move(reason)});
            return;
        }
        Cell cell = make_cell(asked.scene, backend_, asked.variant, asked.settings.width, asked.settings.height,
                              own_depth, asked.spp);
        Cell plain = cell;
        add_checkpoints(cell, settings,
                        settings.reference_scene.empty() ? asked.scene : scenes_.at(settings.reference_scene), depth);
        check_reference(cell.convergence->reference, study.name);
        plain.prepared_spp = cell.prepared_spp;
        add_cell(std::move(cell), study.name);
        if (settings.without_checkpoints) {
            add_cell(std::move(plain), study.name + std::string(without_checkpoints_suffix));
        }
    }

    void add_cell(Cell cell, const std::string& study) {
        const auto [known, is_new] = positions_.try_emplace(cell.name, plan_.cells.size());
        if (is_new) {
            plan_.cells.push_back(std::move(cell));
        } else {
            merge(plan_.cells[known->second], cell, study);
        }
        std::vector<std::string>& studies = plan_.cells[known->second].studies;
        if (studies.empty() || studies.back() != study) {
            studies.push_back(study);
        }
    }

    const Suite& suite_;
    Backend backend_;
    const Tuning& tuning_;
    Scenes scenes_;
    Plan plan_;
    std::unordered_map<std::string, std::size_t> positions_;  // index of each cell in the plan, by cell name
};

}  // namespace

Plan make_plan(const Suite& suite, Backend backend, const Tuning& tuning) {
    return PlanMaker(suite, backend, tuning).make();
}

}  // namespace pt
