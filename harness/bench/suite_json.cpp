// Parses suite files (JSON).
#include "harness/bench/suite.h"

#include <algorithm>

#include <fmt/format.h>

#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

#include "harness/bench/convergence_study.h"
#include "harness/bench/older_suites.h"
#include "harness/text_file.h"

namespace pt {

namespace {

std::vector<std::string> read_names(const JsonValue& value) {
    std::vector<std::string> names;
    for (const JsonValue& element : value.elements()) {
        names.push_back(element.text());
        check_once(names, element.file(), element.path());
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
        check_once(depths, element.file(), element.path());
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

// Reads a resolution, [width, height], or an array of resolutions.
std::vector<std::pair<std::uint32_t, std::uint32_t>> read_sizes(const JsonValue& value) {
    if (!value.json().is_array() || value.json().empty() || !value.json().front().is_array()) {
        return {read_size(value)};
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
    for (const JsonValue& element : value.elements()) {
        sizes.push_back(read_size(element));
        check_once(sizes, element.file(), element.path());
    }
    return sizes;
}

// Reads a study's resolutions, or an object with those of each backend, because a GPU needs more pixels to be busy.
void read_resolution(const JsonValue& value, Study& study) {
    if (value.json().is_object()) {
        const JsonObject object(value, {"cpu", "cuda"});
        for (const Backend backend : all_backends) {
            study.sizes_on[backend] = read_sizes(object.required(std::string(to_string(backend))));
        }
        return;
    }
    const auto sizes = read_sizes(value);
    std::tie(study.width, study.height) = sizes.front();
    study.more_sizes.assign(sizes.begin() + 1, sizes.end());
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
            check_once(values, element.file(), element.path());
        }
        if (values.empty()) {
            JsonValue(json, value.file(), path).fail("at least one value");
        }
    }
    return tunables;
}

// Reads `spp`: a number, an array of numbers, or an object with a number for each backend, because a GPU needs more
// samples per pixel for a measurable time.
void read_spp(const JsonValue& value, Study& study) {
    const auto count = [](const JsonValue& v) {
        return static_cast<std::uint32_t>(v.whole(1, 1000000, "a whole number from 1 to 1000000"));
    };
    if (value.json().is_array()) {
        std::vector<std::uint32_t> counts;
        for (const JsonValue& element : value.elements()) {
            counts.push_back(count(element));
            check_once(counts, element.file(), element.path());
        }
        if (counts.empty()) {
            value.fail("at least one number of samples");
        }
        study.spp = counts.front();
        study.more_spp.assign(counts.begin() + 1, counts.end());
        return;
    }
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

std::vector<std::string> tunables_in(const JsonObject& study) {
    std::vector<std::string> names;
    if (study.has("tunables") && study.at("tunables").json().is_object()) {
        for (const auto& [tunable, values] : study.at("tunables").json().items()) {
            names.push_back(tunable);
        }
    }
    return names;
}

Compared read_compared(const JsonObject& object, bool is_convergence) {
    if (object.has(older_figure_key) && (object.has("compares") || object.has("along"))) {
        object.at(older_figure_key).fail("`compares` alone, which has taken its place");
    }
    if (is_convergence) {
        if (object.has(older_figure_key)) {
            (void)object.at(older_figure_key).one_of({"convergence"});
        }
        return {};  // a study of errors has no key `compares`
    }
    if (object.has(older_figure_key)) {
        return compared_by_figure(object.at(older_figure_key), tunables_in(object));
    }
    Compared compared;
    if (object.has("compares")) {
        std::vector<std::string> names{live_paths};
        names.insert(names.end(), std::begin(axis_names), std::end(axis_names));
        const bool can_be_tunable = !object.has("along");
        const std::vector<std::string> tunables = can_be_tunable ? tunables_in(object) : std::vector<std::string>();
        names.insert(names.end(), tunables.begin(), tunables.end());
        compared.compares = object.at("compares").one_of(names);
    }
    if (object.has("along")) {
        if (compared.compares.empty() || compared.compares == live_paths) {
            object.at("along").fail("none without an axis that the study compares");
        }
        compared.along = object.at("along").one_of({std::begin(all_along), std::end(all_along)});
    }
    return compared;
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

// A study as a JSON object. Keys that only the other type of study may have (convergence or not) are refused by name.
JsonObject study_object(const JsonValue& value) {
    std::vector<std::string> keys{"name",     "type",       "title", "scenes", "axes",          "tunables",
                                  "variants", "resolution", "depth", "spp",    older_figure_key};
    const bool is_convergence = value.json().is_object() && value.json().value("type", Json()) == "convergence";
    if (!is_convergence) {
        keys.insert(keys.end(), {"compares", "along"});
    } else {
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
    const Compared compared = read_compared(object, is_convergence);
    study.compares = compared.compares;
    study.along = compared.along;
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
        read_resolution(object.at("resolution"), study);
    }
    if (object.has("depth")) {
        study.depths = read_depths(object.at("depth"));
    }
    if (object.has("spp")) {
        read_spp(object.at("spp"), study);
    }
    return study;
}

// A convergence study adds a second study, which times its cells without checkpoints; that study's name must be free.
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

void check_repetitions(const Suite& suite, const JsonObject& root) {
    const bool has_convergence = std::any_of(suite.studies.begin(), suite.studies.end(),
                                             [](const Study& s) { return s.convergence.has_value(); });
    if (has_convergence && suite.repetitions < limits::fewest_seeds) {
        root.at("repetitions")
            .fail(fmt::format("{} or more: the suite has a study of type convergence", limits::fewest_seeds));
    }
}

}  // namespace

Suite load_suite(const std::string& file) { return parse_suite(read_text_file(file), file); }

Suite parse_suite(const std::string& text, const std::string& file) {
    const Json json = parse_json(text, file);
    const JsonObject root(JsonValue(json, file, "$"),
                          {"name", "description", "repetitions", "decide_seconds", "studies"});
    Suite suite;
    suite.name = root.required("name").plain_name();
    suite.description = root.has("description") ? root.at("description").text() : "";
    if (root.has("repetitions")) {
        suite.repetitions = static_cast<int>(root.at("repetitions").whole(1, 10000, "a whole number from 1 to 10000"));
    }
    if (root.has("decide_seconds")) {
        suite.decide_seconds =
            static_cast<int>(root.at("decide_seconds").whole(0, 86400, "a whole number of seconds from 0 to 86400"));
    }
    std::vector<std::string> names;
    for (const JsonValue& study : root.required("studies").elements()) {
        names.push_back(suite.studies.emplace_back(read_study(study)).name);
        check_once(names, file, study.path() + ".name");
    }
    if (names.empty()) {
        root.at("studies").fail("at least one study");
    }
    check_names(suite, file);
    check_repetitions(suite, root);
    return suite;
}

}  // namespace pt
