#include "harness/cli/stability_tasks.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/commands.h"
#include "harness/nearest_name.h"
#include "harness/stability/timed_variants.h"
#include "harness/words.h"

namespace pt {

namespace {

using stability::Case;
using stability::Task;

const Case& find_case(const std::string& name) {
    std::vector<std::string> names;
    for (const Case& stiff_case : stability::catalogue()) {
        if (stiff_case.name == name || stiff_case.catalogue == name) {
            return stiff_case;
        }
        names.push_back(stiff_case.name);
    }
    throw InputError("--case", "name", "\"" + name + "\"",
                     fmt::format("{}{}", fmt::join(names, ", "), did_you_mean(name, names)));
}

// Parses parameter values, each "NAME=VALUE".
std::map<std::string, double> parse_values(const std::vector<std::string>& arguments) {
    std::map<std::string, double> values;
    for (const std::string& argument : arguments) {
        const std::size_t equals = argument.find('=');
        const bool has_name = equals != std::string::npos && equals != 0;
        const auto value = has_name ? parse_number<double>(argument.substr(equals + 1)) : std::nullopt;
        if (!value) {
            throw InputError("--set", "argument", "\"" + argument + "\"", "NAME=NUMBER");
        }
        if (!values.try_emplace(argument.substr(0, equals), *value).second) {
            throw InputError("--set", "argument", argument.substr(0, equals) + " twice", "once");
        }
    }
    return values;
}

std::vector<Variant> standard_variants(Backend backend, bool quick) {
    const Registry& registry = Registry::instance();
    const Variant plainest = stability::plainest_variant(backend);
    AxisChoices axes{{axes::robustness, {"robust", "naive"}}};
    for (const char* axis : {axes::precision, axes::arithmetic}) {
        for (const Choice* choice : registry.choices(axis, backend)) {
            axes[axis].emplace_back(choice->descriptor.name);
        }
    }
    const auto with_plainest = [&](AxisChoices choices) {
        for (const std::string_view axis : axis_names) {
            choices.try_emplace(std::string(axis), std::vector<std::string>{plainest[axis]});
        }
        return expand(choices, backend);
    };
    std::vector<Variant> variants = with_plainest(axes);
    std::erase_if(variants, [&](const Variant& variant) {
        const auto is_changed = [&](const auto& axis) { return variant[axis.first] != plainest[axis.first]; };
        return quick && std::count_if(axes.begin(), axes.end(), is_changed) > 1;
    });
    for (const Choice* integrator : registry.choices(axes::integrator, backend)) {
        Variant variant = plainest;
        variant.set(axes::integrator, std::string(integrator->descriptor.name));
        if (std::find(variants.begin(), variants.end(), variant) == variants.end()) {
            variants.push_back(variant);
        }
    }
    return variants;
}

bool is_named(const std::string& axis, const StabilityRequest& request) {
    return std::any_of(request.axes.begin(), request.axes.end(),
                       [&](const std::string& argument) { return argument.starts_with(axis + "="); });
}

// The variant `plain` with every other accelerator, and with every tree builder: all must find the same hits.
std::vector<Variant> accelerated_variants(const Variant& plain, Backend backend) {
    const Registry& registry = Registry::instance();
    std::vector<Variant> variants;
    const auto add = [&](const std::string& accelerator, const std::string& builder) {
        Variant variant = plain;
        variant.set(axes::accelerator, accelerator);
        variant.set(axes::builder, builder);
        if (variant != plain && std::find(variants.begin(), variants.end(), variant) == variants.end()) {
            variants.push_back(variant);
        }
    };
    std::string with_tree;
    for (const Choice* accelerator : registry.choices(axes::accelerator, backend)) {
        const std::string name(accelerator->descriptor.name);
        add(name, plain[axes::builder]);
        with_tree = accelerator->hook.accelerator.encode != nullptr ? name : with_tree;
    }
    for (const Choice* builder : registry.choices(axes::builder, backend)) {
        add(with_tree, std::string(builder->descriptor.name));
    }
    return variants;
}

// Adds two variants for each accelerator: one made from the first half of the variants `timed`, one from the second.
void add_accelerators(std::vector<Variant>& all, const std::vector<Variant>& timed, std::size_t turn, Backend backend) {
    const std::vector<const Choice*> accelerators = Registry::instance().choices(axes::accelerator, backend);
    for (std::size_t i = 0; i < accelerators.size(); ++i) {
        for (const std::size_t half : {std::size_t{0}, timed.size() / 2}) {
            Variant variant = timed[(i + turn + half) % timed.size()];
            variant.set(axes::accelerator, std::string(accelerators[i]->descriptor.name));
            all.push_back(variant);
        }
    }
}

// The estimators that a case asks for, as sets of choices, except those on axes that the option --axis names.
std::vector<std::map<std::string, std::string>> estimators_of(const Case& stiff_case, const StabilityRequest& request) {
    std::vector<std::map<std::string, std::string>> estimators;
    for (const auto& [axis, choices] : stiff_case.estimators) {
        for (const std::string& choice : choices) {
            estimators.push_back({{axis, choice}});
        }
    }
    estimators.insert(estimators.end(), stiff_case.joint_estimators.begin(), stiff_case.joint_estimators.end());
    std::erase_if(estimators, [&](const auto& choices) {
        return std::any_of(choices.begin(), choices.end(),
                           [&](const auto& choice) { return is_named(choice.first, request); });
    });
    return estimators;
}

Variant with_choices(Variant variant, const std::map<std::string, std::string>& choices) {
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

// Adds the timed variants, and for each estimator and each accelerator of the case two timed variants changed to it.
void add_timed(std::vector<Variant>& all, const Case& stiff_case, const StabilityRequest& request, Backend backend) {
    const std::vector<Case>& catalogue = stability::catalogue();
    const auto turn = static_cast<std::size_t>(&stiff_case - catalogue.data());
    const std::vector<Variant> timed = stability::timed_variants(backend, turn, request.quick);
    if (timed.empty()) {
        return;
    }
    all.insert(all.end(), timed.begin(), timed.end());
    std::size_t next = turn;
    for (const auto& choices : estimators_of(stiff_case, request)) {
        for (const std::size_t half : {std::size_t{0}, timed.size() / 2}) {
            all.push_back(with_choices(timed[(next + half) % timed.size()], choices));
        }
        ++next;
    }
    if (stiff_case.over_accelerators) {
        add_accelerators(all, timed, turn, backend);
    }
}

std::vector<stability::Values> points_of(const Case& stiff_case, const StabilityRequest& request) {
    const std::map<std::string, double> set = parse_values(request.values);
    if (!set.empty()) {
        return {values_of(stiff_case, set)};
    }
    std::vector<stability::Values> points;
    if (request.quick && (!stiff_case.quick_points.empty() || stiff_case.points.empty())) {
        for (const auto& point : stiff_case.quick_points) {
            points.push_back(values_of(stiff_case, point));
        }
    } else {
        for (const auto& point : stiff_case.points) {
            points.push_back(values_of(stiff_case, point));
            if (request.quick) {
                break;
            }
        }
    }
    if (points.empty()) {
        points.push_back(values_of(stiff_case, {}));
    }
    return points;
}

std::vector<Task> tasks_of(const Case& stiff_case, const StabilityRequest& request, Backend backend,
                           const std::vector<Variant>& variants) {
    std::vector<Task> tasks;
    for (const stability::Values& values : points_of(stiff_case, request)) {
        for (const Variant& variant : variants_of_case(variants, stiff_case, request, backend)) {
            tasks.push_back({&stiff_case, values, backend, variant, request.seed, request.quick, request.paths});
        }
    }
    return tasks;
}

}  // namespace

std::vector<const Case*> chosen_cases(const StabilityRequest& request) {
    std::vector<const Case*> cases;
    std::vector<std::string> names;  // "lamp" and its catalogue number name the same case
    for (const std::string& argument : request.cases) {
        for (const std::string& name : split_names(argument, "--case")) {
            cases.push_back(&find_case(name));
            names.push_back(cases.back()->name);
            check_once(names, "--case", "argument");
        }
    }
    std::vector<std::string> families;
    for (const std::string& family : request.families) {
        families.push_back(family);
        check_once(families, "--family", "argument");
        if (std::find(std::begin(stability::families), std::end(stability::families), family) ==
            std::end(stability::families)) {
            throw InputError("--family", "name", "\"" + family + "\"",
                             fmt::format("{}", fmt::join(stability::families, ", ")));
        }
    }
    for (const Case& stiff_case : stability::catalogue()) {
        const bool by_family =
            std::find(request.families.begin(), request.families.end(), stiff_case.family) != request.families.end();
        const bool all = request.cases.empty() && request.families.empty();
        if ((all || by_family) && std::find(cases.begin(), cases.end(), &stiff_case) == cases.end()) {
            cases.push_back(&stiff_case);
        }
    }
    return cases;
}

std::vector<Variant> asked_variants(const StabilityRequest& request, Backend backend) {
    if (request.axes.empty()) {
        return standard_variants(backend, request.quick);
    }
    const Variant plainest = stability::plainest_variant(backend);
    AxisChoices axes = parse_axis_arguments(request.axes, backend);
    for (const std::string_view axis : axis_names) {
        axes.try_emplace(std::string(axis), std::vector<std::string>{plainest[axis]});
    }
    return expand(axes, backend);
}

std::vector<Variant> variants_of_case(const std::vector<Variant>& variants, const Case& stiff_case,
                                      const StabilityRequest& request, Backend backend) {
    std::vector<Variant> all = variants;
    if (stiff_case.over_accelerators && !is_named(axes::accelerator, request) && !is_named(axes::builder, request)) {
        for (const Variant& variant : accelerated_variants(stability::plainest_variant(backend), backend)) {
            all.push_back(variant);
        }
    }
    for (const auto& choices : estimators_of(stiff_case, request)) {
        for (const Variant& variant : variants) {
            all.push_back(with_choices(variant, choices));
        }
    }
    if (request.axes.empty()) {
        add_timed(all, stiff_case, request, backend);
    }
    std::vector<Variant> each_once;
    for (const Variant& variant : all) {
        if (std::find(each_once.begin(), each_once.end(), variant) == each_once.end()) {
            each_once.push_back(variant);
        }
    }
    return each_once;
}

std::vector<Task> all_tasks(const StabilityRequest& request, Backend backend) {
    const std::vector<Variant> variants = asked_variants(request, backend);
    std::vector<Task> tasks;
    for (const Case* stiff_case : chosen_cases(request)) {
        for (Task& task : tasks_of(*stiff_case, request, backend, variants)) {
            tasks.push_back(std::move(task));
        }
    }
    return tasks;
}

}  // namespace pt
