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

// Throws InputError if the last element stands twice in the list.
template <class T>
void check_new(const std::vector<T>& list, const std::string& file, const std::string& place) {
    if (std::count(list.begin(), list.end(), list.back()) > 1) {
        throw InputError(file, place, fmt::format("{} twice", Json(list.back()).dump()), "once");
    }
}

std::vector<std::string> read_names(const JsonValue& value) {
    std::vector<std::string> names;
    for (const JsonValue& element : value.elements()) {
        names.push_back(element.text());
        check_new(names, element.file(), element.path());
    }
    if (names.empty()) {
        value.fail("at least one name");
    }
    return names;
}

std::vector<std::uint32_t> read_depths(const JsonValue& value) {
    const std::string allowed = "a whole number from 1 to 1000000, or an array of such";
    const auto depth = [&](const JsonValue& v) { return static_cast<std::uint32_t>(v.whole(1, 1000000, allowed)); };
    if (!value.json().is_array()) {
        return {depth(value)};
    }
    std::vector<std::uint32_t> depths;
    for (const JsonValue& element : value.elements()) {
        depths.push_back(depth(element));
        check_new(depths, element.file(), element.path());
    }
    if (depths.empty()) {
        value.fail("at least one depth");
    }
    return depths;
}

std::pair<std::uint32_t, std::uint32_t> read_size(const JsonValue& value) {
    const std::vector<JsonValue> sides = value.elements();
    if (sides.size() != 2) {
        value.fail("an array of 2 whole numbers, [width, height]");
    }
    return {static_cast<std::uint32_t>(sides[0].whole(1, 8192, "a whole number from 1 to 8192")),
            static_cast<std::uint32_t>(sides[1].whole(1, 8192, "a whole number from 1 to 8192"))};
}

// [width, height], or an array of such.
void read_sizes(const JsonValue& value, Study& study) {
    if (!value.json().is_array() || value.json().empty() || !value.json().front().is_array()) {
        std::tie(study.width, study.height) = read_size(value);
        return;
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
    for (const JsonValue& element : value.elements()) {
        sizes.push_back(read_size(element));
        check_new(sizes, element.file(), element.path());
    }
    std::tie(study.width, study.height) = sizes.front();
    study.more_sizes.assign(sizes.begin() + 1, sizes.end());
}

// A build without a CUDA toolkit does not know that backend's tunables: they tune nothing there.
bool may_be_known_elsewhere(const std::string& name) {
    const std::vector<Tunable> known = tunables_on_any_backend();
    return !choices_not_built.empty() &&
           std::none_of(known.begin(), known.end(), [&](const Tunable& tunable) { return tunable.name == name; });
}

TunableValues read_tunables(const JsonValue& value) {
    if (!value.json().is_object()) {
        value.fail("an object of arrays of whole numbers, by tunable");
    }
    TunableValues tunables;
    for (const auto& [name, json] : value.json().items()) {
        std::vector<std::uint32_t>& values = tunables[name];
        const std::string path = value.path() + "." + name;
        for (const JsonValue& element : JsonValue(json, value.file(), path).elements()) {
            values.push_back(static_cast<std::uint32_t>(element.whole(0, 1000000000, "a whole number")));
            if (!may_be_known_elsewhere(name)) {
                check_tunable(name, values.back(), element.file(), element.path());
            }
            check_new(values, element.file(), element.path());
        }
        if (values.empty()) {
            JsonValue(json, value.file(), path).fail("at least one value");
        }
    }
    return tunables;
}

// A number, or an object with one by backend: a GPU needs more samples than a CPU for a time that can be measured.
void read_spp(const JsonValue& value, Study& study) {
    const auto count = [](const JsonValue& v) {
        return static_cast<std::uint32_t>(v.whole(1, 1000000, "a whole number from 1 to 1000000"));
    };
    if (!value.json().is_object()) {
        study.spp = count(value);
        return;
    }
    const JsonObject object(value, {"cpu", "cuda"});
    for (const Backend backend : all_backends) {
        study.spp_on[backend] = count(object.required(std::string(to_string(backend))));
    }
}

AxisChoices read_axes(const JsonValue& value) {
    if (!value.json().is_object()) {
        value.fail("an object of arrays of choices, by axis");
    }
    AxisChoices axes;
    for (const auto& [axis, choices] : value.json().items()) {
        axes[axis] = read_names(JsonValue(choices, value.file(), value.path() + "." + axis));
    }
    check_choices(axes, value.file(), value.path());
    return axes;
}

VariantSet read_variant_set(const JsonObject& object) {
    VariantSet set;
    if (object.has("axes")) {
        set.axes = read_axes(object.at("axes"));
    }
    if (object.has("tunables")) {
        set.tunables = read_tunables(object.at("tunables"));
    }
    return set;
}

std::string read_figure(const JsonObject& object, bool is_convergence) {
    if (is_convergence) {
        return object.at("figure").one_of({"convergence"});
    }
    std::vector<std::string> figures{"remaining_paths",        "sorting_by_depth", "first_bounce_by_depth",
                                     "scaling_by_resolution",  "scaling_by_depth", "scaling_by_materials",
                                     "scaling_by_shading_fmas"};
    figures.insert(figures.end(), std::begin(axis_names), std::end(axis_names));
    if (object.has("tunables") && object.at("tunables").json().is_object()) {
        for (const auto& [tunable, values] : object.at("tunables").json().items()) {
            figures.push_back(tunable);
        }
    }
    return object.at("figure").one_of(figures);
}

std::vector<VariantSet> read_variants(const JsonValue& value) {
    std::vector<VariantSet> sets;
    for (const JsonValue& element : value.elements()) {
        sets.push_back(read_variant_set(JsonObject(element, {"axes", "tunables"})));
    }
    if (sets.empty()) {
        value.fail("at least one set of choices");
    }
    return sets;
}

// The object's keys are those of its type; what only the other type has is named as such.
JsonObject study_object(const JsonValue& value) {
    std::vector<std::string> keys{"name",     "type",     "title",      "figure", "scenes", "axes",
                                  "tunables", "variants", "resolution", "depth",  "spp"};
    const bool is_convergence = value.json().is_object() && value.json().value("type", Json()) == "convergence";
    if (is_convergence) {
        keys.insert(keys.end(), convergence_keys.begin(), convergence_keys.end());
    }
    return {value, keys};
}

Study read_study(const JsonValue& value) {
    const JsonObject object = study_object(value);
    Study study;
    const bool is_convergence =
        object.has("type") && object.at("type").one_of({"time", "convergence"}) == "convergence";
    study.name = object.required("name").plain_name();
    study.title = object.has("title") ? object.at("title").text() : study.name;
    if (object.has("figure")) {
        study.figure = read_figure(object, is_convergence);
    }
    study.scenes = read_names(object.required("scenes"));
    const VariantSet common = read_variant_set(object);
    study.axes = common.axes;
    study.tunables = common.tunables;
    if (object.has("variants")) {
        study.variants = read_variants(object.at("variants"));
    }
    if (is_convergence) {
        study.convergence = read_convergence(object);
    }
    if (object.has("resolution")) {
        read_sizes(object.at("resolution"), study);
    }
    if (object.has("depth")) {
        study.depths = read_depths(object.at("depth"));
    }
    if (object.has("spp")) {
        read_spp(object.at("spp"), study);
    }
    return study;
}

// {0, 0} stands for the scene's own size.
std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_of(const Study& study) {
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
        check_new(names, "--axis", "argument." + axis);
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
        check_new(values, "--tune", "argument." + name);
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

namespace {

// A study of error brings another one, of its cells without checkpoints.
void check_names(const Suite& suite, const std::string& file) {
    for (std::size_t i = 0; i < suite.studies.size(); ++i) {
        const std::string twin = suite.studies[i].name + std::string(without_checkpoints_suffix);
        if (suite.studies[i].convergence &&
            std::any_of(suite.studies.begin(), suite.studies.end(), [&](const Study& s) { return s.name == twin; })) {
            throw InputError(file, fmt::format("$.studies[{}].name", i), "\"" + suite.studies[i].name + "\"",
                             "a name to which " + std::string(without_checkpoints_suffix) + " can be added");
        }
    }
}

// Error bars come from seeds only, and a spread told from fewer is none (shared/numerics.md 1.6).
void check_repetitions(const Suite& suite, const JsonObject& root) {
    constexpr int least = 8;
    const bool has_convergence = std::any_of(suite.studies.begin(), suite.studies.end(),
                                             [](const Study& s) { return s.convergence.has_value(); });
    if (has_convergence && suite.repetitions < least) {
        root.at("repetitions").fail("8 or more: the suite has a study of type convergence");
    }
}

}  // namespace

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

Suite load_suite(const std::string& file) {
    const Json json = parse_json(read_file(file), file);
    const JsonObject root(JsonValue(json, file, "$"), {"name", "description", "repetitions", "studies"});
    Suite suite;
    suite.name = root.required("name").plain_name();
    suite.description = root.has("description") ? root.at("description").text() : "";
    if (root.has("repetitions")) {
        suite.repetitions = static_cast<int>(root.at("repetitions").whole(1, 10000, "a whole number from 1 to 10000"));
    }
    std::vector<std::string> names;
    for (const JsonValue& study : root.required("studies").elements()) {
        names.push_back(suite.studies.emplace_back(read_study(study)).name);
        check_new(names, file, study.path() + ".name");
    }
    if (names.empty()) {
        root.at("studies").fail("at least one study");
    }
    check_names(suite, file);
    check_repetitions(suite, root);
    return suite;
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

// A variant of a study on a scene, at every size and depth.
void add_cells(Plan& plan, Scenes& scenes, const Study& study, const std::shared_ptr<const Scene>& scene,
               const Variant& variant, Backend backend) {
    const std::vector<std::uint32_t> depths =
        study.depths.empty() ? std::vector<std::uint32_t>{scene->max_depth} : study.depths;
    for (const auto& [width, height] : sizes_of(study)) {
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
