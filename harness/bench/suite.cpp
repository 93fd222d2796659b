#include "harness/bench/suite.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "choices_not_built.h"  // generated
#include "harness/bench/convergence_study.h"
#include "harness/json_reader.h"
#include "harness/places.h"

namespace pt {

namespace {

// The choices of an axis on any backend, each name once; those that this build lacks too.
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

// Those of every choice, so a name may be there several times.
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

// {0, 0} stands for the scene's own size.
std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_of(const Study& study, Backend backend) {
    if (const auto own = study.sizes_on.find(backend); own != study.sizes_on.end()) {
        return own->second;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes{{study.width, study.height}};
    sizes.insert(sizes.end(), study.more_sizes.begin(), study.more_sizes.end());
    return sizes;
}

Cell make_cell(const std::shared_ptr<const Scene>& scene, Backend backend, const Variant& variant, const Study& study,
               std::uint32_t width, std::uint32_t height, std::uint32_t depth) {
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
    cell.spp = study.spp_for(backend);
    cell.name = fmt::format("{}/scene:{}/backend:{}/resolution:{}x{}/depth:{}/spp:{}", variant.name(), scene->name,
                            to_string(backend), cell.settings.width, cell.settings.height, depth, cell.spp);
    return cell;
}

// Two studies may ask for one cell, which has one reference: as good as the better of the two.
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

void add_cell(Plan& plan, Cell cell, const std::string& study) {
    const auto known =
        std::find_if(plan.cells.begin(), plan.cells.end(), [&](const Cell& c) { return c.name == cell.name; });
    if (known != plan.cells.end()) {
        merge(*known, cell, study);
    }
    Cell& target = known != plan.cells.end() ? *known : plan.cells.emplace_back(std::move(cell));
    if (target.studies.empty() || target.studies.back() != study) {
        target.studies.push_back(study);
    }
}

using Scenes = std::map<std::string, std::shared_ptr<const Scene>>;  // by name or file

// Loads a scene once. Results know a scene by the name in its file: two different scenes of one name are an error.
std::shared_ptr<const Scene> scene_of(Scenes& scenes, const std::string& name_or_file) {
    const auto [position, is_new] = scenes.try_emplace(name_or_file);
    if (is_new) {
        position->second = std::make_shared<const Scene>(find_scene(name_or_file));
        for (const auto& [other_file, other] : scenes) {
            if (other->name == position->second->name && other->hash != position->second->hash) {
                throw InputError(name_or_file, "$.name",
                                 "\"" + other->name + "\", the name of another scene (" + other_file + ")",
                                 "a name of its own");
            }
        }
    }
    return position->second;
}

}  // namespace

bool may_be_known_elsewhere(const std::string& name) {
    const std::vector<Tunable> known = tunables_on_any_backend();
    return !choices_not_built.empty() &&
           std::none_of(known.begin(), known.end(), [&](const Tunable& tunable) { return tunable.name == name; });
}

void check_choices(const AxisChoices& axes, const std::string& file, const std::string& place) {
    for (const auto& [axis, names] : axes) {
        if (std::find(std::begin(axis_names), std::end(axis_names), axis) == std::end(axis_names)) {
            throw InputError(file, place, "axis \"" + axis + "\"", fmt::format("{}", fmt::join(axis_names, ", ")));
        }
        const std::vector<std::string> known = names_on_any_backend(axis);
        for (const std::string& name : names) {
            if (std::find(known.begin(), known.end(), name) == known.end()) {
                throw InputError(file, place + "." + axis, "\"" + name + "\"",
                                 fmt::format("{}", fmt::join(known, ", ")));
            }
        }
    }
}

void add_axis_argument(AxisChoices& axes, const std::string& argument, Backend backend) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == argument.size()) {
        throw InputError("--axis", "argument", "\"" + argument + "\"", "NAME=CHOICE or NAME=CHOICE,CHOICE");
    }
    const std::string axis = argument.substr(0, equals);
    std::vector<std::string> names;
    std::size_t start = equals + 1;
    while (start <= argument.size()) {
        const std::size_t comma = std::min(argument.find(',', start), argument.size());
        names.push_back(argument.substr(start, comma - start));
        check_once(names, "--axis", "argument." + axis);
        start = comma + 1;
    }
    if (names == std::vector<std::string>{"all"}) {
        check_choices({{axis, {}}}, "--axis", "argument");
        names = names_of(Registry::instance().choices(axis, backend));
    }
    check_choices({{axis, names}}, "--axis", "argument");
    axes[axis] = names;
}

// Choices may allow different values of a tunable of one name: what some of them allow is not applicable to the others.
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
        throw InputError(file, place, "tunable \"" + name + "\"", fmt::format("{}", fmt::join(known, ", ")));
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
    const char* begin = argument.data() + equals + 1;
    const char* const end = argument.data() + argument.size();
    while (begin <= end) {
        std::uint32_t value = 0;
        const auto parsed = std::from_chars(begin, end, value);
        if (parsed.ec != std::errc() || (parsed.ptr != end && *parsed.ptr != ',')) {
            throw InputError("--tune", "argument." + name, "\"" + argument + "\"", "whole numbers, comma-separated");
        }
        check_tunable(name, value, "--tune", "argument." + name);
        values.push_back(value);
        check_once(values, "--tune", "argument." + name);
        begin = parsed.ptr + 1;
    }
    tunables[name] = values;
}

AxisChoices all_choices(Backend backend) {
    AxisChoices all;
    for (const std::string_view axis : axis_names) {
        all[std::string(axis)] = names_of(Registry::instance().choices(axis, backend));
    }
    return all;
}

namespace {

// What a tunable is in a variant that does not name it: the standard of the choice that has it, which another choice of
// the same axis need not share. Where none of the variant's has it, the first of the backend's that does.
std::optional<std::uint32_t> standard_of(const Variant& variant, const std::string& name, Backend backend) {
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
    return position != tunables.end() ? std::optional(position->standard) : std::nullopt;
}

// Every variant of `variants` with every value of a tunable. Standards are left out: one variant has one name.
std::vector<Variant> with_values(const std::vector<Variant>& variants, const std::string& name,
                                 const std::vector<std::uint32_t>& values, Backend backend) {
    std::vector<Variant> next;
    for (const Variant& variant : variants) {
        const std::optional<std::uint32_t> standard = standard_of(variant, name, backend);
        for (const std::uint32_t value : values) {
            next.push_back(variant);
            if (standard != value) {
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
    for (VariantSet set : study.variants) {
        set.axes.insert(study.axes.begin(), study.axes.end());
        set.tunables.insert(study.tunables.begin(), study.tunables.end());
        for (Variant& variant : expand(set.axes, backend, set.tunables)) {
            if (std::find(variants.begin(), variants.end(), variant) == variants.end()) {
                variants.push_back(std::move(variant));
            }
        }
    }
    return variants;
}

namespace {

// The tunables that a study names, in any of its sets.
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
        throw InputError(fmt::format("study {}: its reference {} cannot be rendered on {}: {}", study, variant.name(),
                                     to_string(task.backend), reason));
    }
}

// A variant of a study on a scene, at every size and depth.
void add_cells(Plan& plan, Scenes& scenes, const Study& study, const std::shared_ptr<const Scene>& scene,
               const Variant& variant, Backend backend) {
    const std::vector<std::uint32_t> depths =
        study.depths.empty() ? std::vector<std::uint32_t>{scene->max_depth} : study.depths;
    for (const auto& [width, height] : sizes_of(study, backend)) {
        for (const std::uint32_t depth : depths) {
            if (!study.convergence) {
                add_cell(plan, make_cell(scene, backend, variant, study, width, height, depth), study.name);
                continue;
            }
            const std::uint32_t own_depth = depth_for_mean_of(variant, backend, depth);
            if (own_depth == 0) {
                plan.not_applicable.push_back({study.name, scene->name, variant,
                                               fmt::format("has no depth at which its mean is that of {}", depth)});
                continue;
            }
            const std::string& right = study.convergence->reference_scene;
            Cell cell = make_cell(scene, backend, variant, study, width, height, own_depth);
            Cell plain = cell;
            add_checkpoints(cell, *study.convergence, right.empty() ? scene : scene_of(scenes, right), depth);
            check_reference(cell.convergence->reference, study.name);
            plain.prepared_spp = cell.prepared_spp;
            add_cell(plan, std::move(cell), study.name);
            if (study.convergence->without_checkpoints) {
                add_cell(plan, std::move(plain), study.name + std::string(without_checkpoints_suffix));
            }
        }
    }
}

}  // namespace

Plan make_plan(const Suite& suite, Backend backend, const Tuning& tuning) {
    Plan plan;
    Scenes scenes;
    for (const Study& study : suite.studies) {
        const std::set<std::string> named = named_tunables(study);
        for (const std::string& name : study.scenes) {
            const std::shared_ptr<const Scene> scene = scene_of(scenes, name);
            for (const Variant& asked : variants_of(study, backend)) {
                const Variant variant = tuning.applied(asked, named);
                const std::string reason = why_not_applicable(variant, features_of(*scene), backend);
                if (!reason.empty()) {
                    plan.not_applicable.push_back({study.name, scene->name, variant, reason});
                    continue;
                }
                add_cells(plan, scenes, study, scene, variant, backend);
            }
        }
    }
    return plan;
}

}  // namespace pt
