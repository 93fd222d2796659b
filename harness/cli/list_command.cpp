#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/commands.h"
#include "harness/cli/known_names.h"
#include "harness/cli/list_json.h"
#include "harness/cli/list_text.h"
#include "harness/nearest_name.h"
#include "harness/scene/places.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

struct ListArguments {
    std::string topic;
    std::string scene;
    std::string architecture;
    std::string names;
    bool json = false;
};

OrderedJson scenes_of(const ListArguments& arguments) {
    if (!arguments.architecture.empty()) {
        (void)parse_backend("cuda");  // parse_backend() throws if this build lacks the CUDA backend
    }
    OrderedJson scenes = OrderedJson::array();
    for (const std::string& name : arguments.scene.empty() ? scene_names() : split_names(arguments.scene)) {
        scenes.push_back(list_scene(name));
        if (!arguments.architecture.empty()) {
            scenes.back()["kernels"] = list_kernels(name, arguments.architecture);
        }
    }
    return scenes;
}

OrderedJson suites_json() {
    OrderedJson suites = OrderedJson::array();
    for (const std::string& name : suite_names()) {
        suites.push_back(list_suite(name));
    }
    return suites;
}

OrderedJson everything(const ListArguments& arguments) {
    return {{"axes", list_axes()},
            {"scenes", scenes_of(arguments)},
            {"suites", suites_json()},
            {"backends", list_backends()}};
}

// The text about a topic of `ptbench list`: the axes, one axis, the features, the scenes or the suites.
std::string topic_text(const ListArguments& arguments) {
    const std::string& topic = arguments.topic;
    if (topic == "axes") {
        return arguments.json ? list_axis_facts().dump(1) + "\n" : axes_text();
    }
    if (topic == "features") {
        return arguments.json ? list_features().dump(1) + "\n" : features_text();
    }
    if (topic == "scenes") {
        const OrderedJson scenes = scenes_of(arguments);
        return arguments.json ? scenes.dump(1) + "\n" : scenes_text(scenes);
    }
    if (topic == "suites") {
        return arguments.json ? suites_json().dump(1) + "\n" : suites_text();
    }
    std::vector<std::string> allowed = names_of_axes();
    if (std::find(allowed.begin(), allowed.end(), topic) != allowed.end()) {
        const OrderedJson axis = list_axis(topic);
        return arguments.json ? axis.dump(1) + "\n" : axis_text(axis);
    }
    allowed.insert(allowed.end(), {"axes", "features", "scenes", "suites"});
    throw InputError("list", "argument", "\"" + topic + "\"",
                     fmt::format("an axis ({}), axes, features, scenes or suites{}", fmt::join(names_of_axes(), ", "),
                                 did_you_mean(topic, allowed)));
}

std::string text_of(const ListArguments& arguments, const CLI::App& app) {
    if (!arguments.names.empty()) {
        return fmt::format("{}\n", fmt::join(known_names(arguments.names, app), "\n"));
    }
    if (!arguments.topic.empty()) {
        return topic_text(arguments);
    }
    if (arguments.json) {
        return everything(arguments).dump(1) + "\n";
    }
    const bool is_overview = arguments.scene.empty() && arguments.architecture.empty();
    return is_overview ? overview_text() : scenes_text(scenes_of(arguments)) + backends_text();
}

}  // namespace

Command add_list_command(CLI::App& app) {
    auto arguments = std::make_shared<ListArguments>();
    CLI::App* command =
        app.add_subcommand("list", "Axes, choices, scenes, suites and backends, and what applies where");
    command->add_option(
        "WHAT", arguments->topic,
        "An axis: its choices with claims, origins and tunables; or \"axes\", \"features\" (of kernels), "
        "\"scenes\", \"suites\"");
    command->add_option("--scene", arguments->scene, "These scenes, comma-separated: what they need, what applies");
    command->add_option("--arch", arguments->architecture,
                        "Also compile the scenes' kernels for this GPU, e.g. sm_90, and say what leaving out saves");
    CLI::Option* json = command->add_flag("--json", arguments->json, "As JSON");
    command
        ->add_option(
            "--names", arguments->names,
            fmt::format("Names alone, one a line: of an axis's choices, or {}", fmt::join(kinds_of_names, ", ")))
        ->excludes(json);
    return [arguments, &app] {
        fmt::print("{}", text_of(*arguments, app));
        return exit_good;
    };
}

}  // namespace pt
