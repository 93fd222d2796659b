#include "harness/bench/older_suites.h"

#include <iterator>
#include <map>

#include "harness/bench/suite.h"
#include "variants/axes.h"

namespace pt {

namespace {

// What older suites' figures compare, by figure name, where that is not the name of the compared axis or tunable.
const std::map<std::string, Compared> figures{
    {"remaining_paths", {live_paths, ""}},
    {"sorting_by_depth", {axes::sorting, along_depth}},
    {"first_bounce_by_depth", {axes::first_bounce, along_depth}},
    {"scaling_by_resolution", {"", "resolution"}},
    {"scaling_by_depth", {"", along_depth}},
    {"scaling_by_materials", {"", "materials"}},
    {"scaling_by_shading_fmas", {"", "shading_fmas"}},
};

}  // namespace

Compared compared_by_figure(const JsonValue& figure, const std::vector<std::string>& own_tunables) {
    std::vector<std::string> names;
    for (const auto& [name, compared] : figures) {
        names.push_back(name);
    }
    names.insert(names.end(), std::begin(axis_names), std::end(axis_names));
    names.insert(names.end(), own_tunables.begin(), own_tunables.end());
    const std::string name = figure.one_of(names);
    const auto known = figures.find(name);
    return known == figures.end() ? Compared{name, ""} : known->second;
}

}  // namespace pt
