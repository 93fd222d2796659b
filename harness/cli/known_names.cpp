#include "harness/cli/known_names.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/failure.h"
#include "harness/nearest_name.h"
#include "harness/scene/places.h"
#include "variants/registry.h"

namespace pt {

namespace {

void add_once(std::vector<std::string>& names, std::string_view name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
        names.emplace_back(name);
    }
}

}  // namespace

std::vector<std::string> names_of_choices(std::string_view axis, BackendSet backends) {
    std::vector<std::string> names;
    for (const Backend backend : all_backends) {
        if (contains(backends, backend)) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                add_once(names, choice->descriptor.name);
            }
        }
    }
    return names;
}

std::vector<std::string> names_of_axes() { return {axis_names.begin(), axis_names.end()}; }

std::vector<std::string> names_of_tunables() {
    std::vector<std::string> names;
    for (const Backend backend : all_backends) {
        for (const Tunable& t : all_tunables(backend)) {
            add_once(names, t.name);
        }
    }
    return names;
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

std::vector<std::string> known_names(const std::string& kind_or_axis, const CLI::App& app) {
    if (kind_or_axis == "axes") {
        return names_of_axes();
    }
    if (kind_or_axis == "scenes") {
        return scene_names();
    }
    if (kind_or_axis == "suites") {
        return suite_names();
    }
    if (kind_or_axis == "tunables") {
        return names_of_tunables();
    }
    if (kind_or_axis == "backends") {
        return {"cpu", "cuda"};
    }
    if (kind_or_axis == "commands") {
        return names_of_commands(app);
    }
    std::vector<std::string> allowed = kinds_of_names;
    for (const std::string& axis : names_of_axes()) {
        if (axis == kind_or_axis) {
            return names_of_choices(axis);
        }
        allowed.push_back(axis);
    }
    throw InputError("--names", "argument", "\"" + kind_or_axis + "\"",
                     fmt::format("{}{}", fmt::join(allowed, ", "), did_you_mean(kind_or_axis, allowed)));
}

}  // namespace pt
