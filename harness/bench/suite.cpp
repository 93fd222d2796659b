#include "harness/bench/suite.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/json_reader.h"
#include "harness/places.h"

namespace pt {

namespace {

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

Study read_study(const JsonValue& value) {
    const JsonObject object(value, {"name", "title", "figure", "scenes", "axes", "resolution", "depth", "spp"});
    Study study;
    study.name = object.required("name").plain_name();
    study.title = object.has("title") ? object.at("title").text() : study.name;
    if (object.has("figure")) {
        std::vector<std::string> figures{"remaining_paths", "sorting_by_depth", "first_bounce_by_depth"};
        figures.insert(figures.end(), std::begin(axis_names), std::end(axis_names));
        study.figure = object.at("figure").one_of(figures);
    }
    study.scenes = read_names(object.required("scenes"));
    if (object.has("axes")) {
        const JsonValue axes = object.at("axes");
        if (!axes.json().is_object()) {
            axes.fail("an object of arrays of choices, by axis");
        }
        for (const auto& [axis, choices] : axes.json().items()) {
            study.axes[axis] = read_names(JsonValue(choices, axes.file(), axes.path() + "." + axis));
        }
        check_choices(study.axes, axes.file(), axes.path());
    }
    if (object.has("resolution")) {
        const std::vector<JsonValue> sides = object.at("resolution").elements();
        if (sides.size() != 2) {
            object.at("resolution").fail("an array of 2 whole numbers, [width, height]");
        }
        study.width = static_cast<std::uint32_t>(sides[0].whole(1, 8192, "a whole number from 1 to 8192"));
        study.height = static_cast<std::uint32_t>(sides[1].whole(1, 8192, "a whole number from 1 to 8192"));
    }
    if (object.has("depth")) {
        study.depths = read_depths(object.at("depth"));
    }
    if (object.has("spp")) {
        study.spp = static_cast<std::uint32_t>(object.at("spp").whole(1, 1000000, "a whole number from 1 to 1000000"));
    }
    return study;
}

Cell make_cell(const std::shared_ptr<const Scene>& scene, const Variant& variant, const Study& study,
               std::uint32_t depth) {
    Cell cell;
    cell.scene = scene;
    cell.variant = variant;
    cell.settings = default_settings(*scene);
    if (study.width != 0) {
        cell.settings.width = study.width;
        cell.settings.height = study.height;
    }
    cell.settings.depth = depth;
    cell.spp = study.spp;
    cell.name = fmt::format("{}/scene:{}/backend:cpu/resolution:{}x{}/depth:{}/spp:{}", variant.name(), scene->name,
                            cell.settings.width, cell.settings.height, depth, cell.spp);
    return cell;
}

void add_cell(Plan& plan, Cell cell, const std::string& study) {
    const auto known =
        std::find_if(plan.cells.begin(), plan.cells.end(), [&](const Cell& c) { return c.name == cell.name; });
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
    const Registry& registry = Registry::instance();
    for (const auto& [axis, names] : axes) {
        if (std::find(std::begin(axis_names), std::end(axis_names), axis) == std::end(axis_names)) {
            throw InputError(file, place, "axis \"" + axis + "\"", fmt::format("{}", fmt::join(axis_names, ", ")));
        }
        for (const std::string& name : names) {
            if (registry.find(axis, name) == nullptr) {
                throw InputError(file, place + "." + axis, "\"" + name + "\"",
                                 fmt::format("{}", fmt::join(names_of(registry.choices(axis)), ", ")));
            }
        }
    }
}

void add_axis_argument(AxisChoices& axes, const std::string& argument) {
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
        names = names_of(Registry::instance().choices(axis));
    }
    check_choices({{axis, names}}, "--axis", "argument");
    axes[axis] = names;
}

AxisChoices all_choices() {
    AxisChoices all;
    for (const std::string_view axis : axis_names) {
        all[std::string(axis)] = names_of(Registry::instance().choices(axis));
    }
    return all;
}

std::vector<Variant> expand(const AxisChoices& axes) {
    std::vector<Variant> variants{Registry::instance().baseline()};
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
    return suite;
}

Plan make_plan(const Suite& suite) {
    Plan plan;
    Scenes scenes;
    for (const Study& study : suite.studies) {
        for (const std::string& name : study.scenes) {
            const std::shared_ptr<const Scene> scene = scene_of(scenes, name);
            const std::vector<std::uint32_t> depths =
                study.depths.empty() ? std::vector<std::uint32_t>{scene->max_depth} : study.depths;
            for (const Variant& variant : expand(study.axes)) {
                const std::string reason = why_not_applicable(variant, features_of(*scene));
                if (!reason.empty()) {
                    plan.not_applicable.push_back({study.name, scene->name, variant, reason});
                    continue;
                }
                for (const std::uint32_t depth : depths) {
                    add_cell(plan, make_cell(scene, variant, study, depth), study.name);
                }
            }
        }
    }
    return plan;
}

}  // namespace pt
