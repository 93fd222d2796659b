#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/places.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson axes_json() {
    OrderedJson axes = OrderedJson::array();
    for (const std::string_view axis : axis_names) {
        OrderedJson choices = OrderedJson::array();
        for (const Choice* choice : Registry::instance().choices(axis)) {
            const Descriptor& d = choice->descriptor;
            choices.push_back({{"name", d.name},
                               {"baseline", d.baseline},
                               {"summary", d.summary},
                               {"origin", d.origin},
                               {"backends", {"cpu"}},
                               {"claim", to_string(d.claim)},
                               {"claim_note", d.claim_note}});
        }
        axes.push_back({{"name", axis}, {"choices", choices}});
    }
    return axes;
}

// Per choice: why it does not apply to the scene with everything else at its baseline.
OrderedJson scene_json(const std::string& name) {
    const Scene scene = find_scene(name);
    const FeatureSet features = features_of(scene);
    OrderedJson reasons = OrderedJson::object();
    for (const std::string_view axis : axis_names) {
        for (const Choice* choice : Registry::instance().choices(axis)) {
            Variant variant = Registry::instance().baseline();
            variant.set(axis, std::string(choice->descriptor.name));
            const std::string reason = why_not_applicable(variant, features);
            if (!reason.empty()) {
                reasons[fmt::format("{}={}", axis, choice->descriptor.name)] = reason;
            }
        }
    }
    return {{"name", scene.name},
            {"description", scene.description},
            {"hash", scene.hash},
            {"objects", scene.objects.size()},
            {"materials", scene.materials.size()},
            {"max_depth", scene.max_depth},
            {"resolution", {scene.camera.width, scene.camera.height}},
            {"features", feature_names(features)},
            {"left_out", feature_names(all_features & ~features)},
            {"kernel", choose_kernel(scene, Registry::instance().baseline()).note()},
            {"not_applicable", reasons}};
}

OrderedJson suite_json(const std::string& name) {
    const Suite suite = load_suite(find_suite_file(name));
    return {{"name", suite.name},
            {"description", suite.description},
            {"repetitions", suite.repetitions},
            {"studies", suite.studies.size()}};
}

std::string text_of(const OrderedJson& all) {
    std::string text = "Axes (the first choice of each is the baseline)\n";
    for (const OrderedJson& axis : all["axes"]) {
        text += fmt::format("  {}\n", axis["name"].get<std::string>());
        for (const OrderedJson& choice : axis["choices"]) {
            const std::string note = choice["claim_note"];
            text += fmt::format("    {:<24} {} [{}{}] ({})\n", choice["name"].get<std::string>(),
                                choice["summary"].get<std::string>(), choice["claim"].get<std::string>(),
                                note.empty() ? "" : ": " + note, choice["origin"].get<std::string>());
        }
    }
    text += "Scenes\n";
    for (const OrderedJson& scene : all["scenes"]) {
        text += fmt::format("  {:<26} {}\n", scene["name"].get<std::string>(), scene["description"].get<std::string>());
        text +=
            fmt::format("  {:<26}   needs {}\n", "", fmt::join(scene["features"].get<std::vector<std::string>>(), " "));
        for (const auto& [choice, reason] : scene["not_applicable"].items()) {
            text += fmt::format("  {:<26}   n/a: {}\n", "", reason.get<std::string>());
        }
    }
    text += "Suites\n";
    for (const OrderedJson& suite : all["suites"]) {
        text += fmt::format("  {:<26} {}\n", suite["name"].get<std::string>(), suite["description"].get<std::string>());
    }
    text += "Backends\n";
    for (const OrderedJson& backend : all["backends"]) {
        text += fmt::format("  {:<26} {}\n", backend["name"].get<std::string>(), backend["status"].get<std::string>());
    }
    return text;
}

int run(const std::string& only_scene, bool as_json) {
    OrderedJson scenes = OrderedJson::array();
    for (const std::string& name : only_scene.empty() ? scene_names() : split_names(only_scene)) {
        scenes.push_back(scene_json(name));
    }
    OrderedJson suites = OrderedJson::array();
    for (const std::string& name : suite_names()) {
        suites.push_back(suite_json(name));
    }
    const OrderedJson all{
        {"axes", axes_json()},
        {"scenes", scenes},
        {"suites", suites},
        {"backends",
         {{{"name", "cpu"}, {"status", "available"}},
          {{"name", "cuda"}, {"status", "not available (this version of ptbench has no CUDA backend)"}}}}};
    fmt::print("{}", as_json ? all.dump(1) + "\n" : text_of(all));
    return exit_good;
}

}  // namespace

Command add_list_command(CLI::App& app) {
    struct ListArguments {
        std::string scene;
        bool json = false;
    };
    auto arguments = std::make_shared<ListArguments>();
    CLI::App* command =
        app.add_subcommand("list", "Axes, choices, scenes, suites and backends, and what applies where");
    command->add_option("--scene", arguments->scene, "Only these scenes, comma-separated");
    command->add_flag("--json", arguments->json, "As JSON");
    return [arguments] { return run(arguments->scene, arguments->json); };
}

}  // namespace pt
