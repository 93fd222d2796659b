#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/places.h"
#include "harness/variant_json.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

// Backends that have any choice at all on an axis: a build without a CUDA toolkit has none on some.
bool is_built(Backend backend) {
    return std::all_of(std::begin(axis_names), std::end(axis_names),
                       [&](std::string_view axis) { return !Registry::instance().choices(axis, backend).empty(); });
}

// A choice that several backends have is one entry; its claim and words are those of the first.
OrderedJson choice_json(std::string_view axis, const std::string& name) {
    const Registry& registry = Registry::instance();
    OrderedJson backends = OrderedJson::array();
    OrderedJson baseline_on = OrderedJson::array();
    OrderedJson tunables = OrderedJson::array();
    std::set<std::string_view> tunables_seen;
    const Descriptor* first = nullptr;
    for (const Backend backend : all_backends) {
        const Choice* choice = registry.find(axis, name, backend);
        if (choice == nullptr) {
            continue;
        }
        first = first == nullptr ? &choice->descriptor : first;
        backends.push_back(to_string(backend));
        if (contains(choice->descriptor.baseline, backend)) {
            baseline_on.push_back(to_string(backend));
        }
        for (const Tunable& t : choice->descriptor.tunables) {
            if (tunables_seen.insert(t.name).second) {
                tunables.push_back({{"name", t.name},
                                    {"default_value", t.default_value},
                                    {"lowest", t.lowest},
                                    {"highest", t.highest},
                                    {"multiple_of", t.multiple_of},
                                    {"summary", t.summary}});
            }
        }
    }
    return {{"name", name},
            {"baseline", !baseline_on.empty()},
            {"baseline_on", baseline_on},
            {"summary", first->summary},
            {"origin", first->origin},
            {"backends", backends},
            {"claim", to_string(first->claim)},
            {"claim_note", first->claim_note},
            {"tunables", tunables}};
}

OrderedJson axes_json() {
    OrderedJson axes = OrderedJson::array();
    for (const std::string_view axis : axis_names) {
        std::vector<std::string> names;
        for (const Backend backend : all_backends) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                if (std::find(names.begin(), names.end(), choice->descriptor.name) == names.end()) {
                    names.emplace_back(choice->descriptor.name);
                }
            }
        }
        OrderedJson choices = OrderedJson::array();
        for (const std::string& name : names) {
            choices.push_back(choice_json(axis, name));
        }
        axes.push_back({{"name", axis}, {"choices", choices}});
    }
    return axes;
}

// Per backend and choice: why it does not apply to the scene with everything else at its baseline.
OrderedJson reasons_json(FeatureSet features) {
    OrderedJson all = OrderedJson::object();
    for (const Backend backend : all_backends) {
        if (!is_built(backend)) {
            continue;
        }
        OrderedJson reasons = OrderedJson::object();
        for (const std::string_view axis : axis_names) {
            for (const Choice* choice : Registry::instance().choices(axis, backend)) {
                Variant variant = Registry::instance().baseline(backend);
                variant.set(axis, std::string(choice->descriptor.name));
                const std::string reason = why_not_applicable(variant, features, backend);
                if (!reason.empty()) {
                    reasons[fmt::format("{}={}", axis, choice->descriptor.name)] = reason;
                }
            }
        }
        all[std::string(to_string(backend))] = reasons;
    }
    return all;
}

OrderedJson scene_json(const std::string& name) {
    const Scene scene = find_scene(name);
    const FeatureSet features = features_of(scene);
    const OrderedJson reasons = reasons_json(features);
    return {{"name", scene.name},
            {"description", scene.description},
            {"hash", scene.hash},
            {"objects", scene.objects.size()},
            {"materials", scene.materials.size()},
            {"max_depth", scene.max_depth},
            {"resolution", {scene.camera.width, scene.camera.height}},
            {"features", feature_names(features)},
            {"left_out", feature_names(all_features & ~features)},
            {"shortcuts", feature_names(shortcuts_of(scene))},
            {"kernel", choose_kernel(scene, Registry::instance().baseline()).note()},
            {"not_applicable", reasons.at("cpu")},
            {"not_applicable_on", reasons}};
}

// What leaving out saves: the same kernel of the scene with everything and with less, compiled for a GPU that need not
// be there.
OrderedJson kernels_json(const std::string& name, const std::string& architecture) {
    const Scene scene = find_scene(name);
    OrderedJson kernels = OrderedJson::array();
    for (const Choice* choice : Registry::instance().choices("specialisation", Backend::cuda)) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set("integrator", "megakernel");
        variant.set("specialisation", std::string(choice->descriptor.name));
        const OrderedJson report = cuda::inspect_kernels(scene, variant, architecture);
        OrderedJson entry{{"specialisation", choice->descriptor.name},
                          {"architecture", report["architecture"]},
                          {"features", report["features"]},
                          {"code_bytes", report["code_bytes"]}};
        for (const char* fact : {"registers", "spill_store_bytes", "occupancy", "instructions"}) {
            if (report["kernels"][0].contains(fact)) {
                entry[fact] = report["kernels"][0][fact];
            }
        }
        kernels.push_back(entry);
    }
    return kernels;
}

std::string kernels_text(const OrderedJson& kernels) {
    std::string text;
    for (const OrderedJson& kernel : kernels) {
        text += fmt::format("  {:<26}   megakernel {} for {}: {} registers, {} bytes of code", "",
                            kernel["specialisation"].get<std::string>(), kernel["architecture"].get<std::string>(),
                            kernel["registers"].get<int>(), kernel["code_bytes"].get<std::size_t>());
        if (kernel.contains("instructions")) {
            text += fmt::format(", {} instructions", kernel["instructions"]["total"].get<std::size_t>());
        }
        text += "\n";
    }
    return text;
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
            text += fmt::format("    {:<24} {} [{}{}] ({}) {}\n", choice["name"].get<std::string>(),
                                choice["summary"].get<std::string>(), choice["claim"].get<std::string>(),
                                note.empty() ? "" : ": " + note, choice["origin"].get<std::string>(),
                                fmt::join(choice["backends"].get<std::vector<std::string>>(), "+"));
            for (const OrderedJson& t : choice["tunables"]) {
                text += fmt::format("    {:<24}   tunable {}={} ({} to {}): {}\n", "", t["name"].get<std::string>(),
                                    t["default_value"].get<std::uint32_t>(), t["lowest"].get<std::uint32_t>(),
                                    t["highest"].get<std::uint32_t>(), t["summary"].get<std::string>());
            }
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
        text += fmt::format("  {:<26}   leaves out {}\n", "",
                            fmt::join(scene["left_out"].get<std::vector<std::string>>(), " "));
        if (scene.contains("kernels")) {
            text += kernels_text(scene["kernels"]);
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

std::string cuda_status() {
    const std::string reason = cuda::not_available();
    return reason.empty() ? "available: " + cuda::machine_name() : "not available (" + reason + ")";
}

int run(const std::string& only_scene, const std::string& architecture, bool as_json) {
    OrderedJson scenes = OrderedJson::array();
    if (!architecture.empty()) {
        (void)parse_backend("cuda");  // a build without it has nothing to compile
    }
    for (const std::string& name : only_scene.empty() ? scene_names() : split_names(only_scene)) {
        scenes.push_back(scene_json(name));
        if (!architecture.empty()) {
            scenes.back()["kernels"] = kernels_json(name, architecture);
        }
    }
    OrderedJson suites = OrderedJson::array();
    for (const std::string& name : suite_names()) {
        suites.push_back(suite_json(name));
    }
    const OrderedJson all{
        {"axes", axes_json()},
        {"scenes", scenes},
        {"suites", suites},
        {"backends", {{{"name", "cpu"}, {"status", "available"}}, {{"name", "cuda"}, {"status", cuda_status()}}}}};
    fmt::print("{}", as_json ? all.dump(1) + "\n" : text_of(all));
    return exit_good;
}

}  // namespace

Command add_list_command(CLI::App& app) {
    struct ListArguments {
        std::string scene;
        std::string architecture;
        bool json = false;
    };
    auto arguments = std::make_shared<ListArguments>();
    CLI::App* command =
        app.add_subcommand("list", "Axes, choices, scenes, suites and backends, and what applies where");
    command->add_option("--scene", arguments->scene, "Only these scenes, comma-separated");
    command->add_option("--arch", arguments->architecture,
                        "Also compile the scenes' kernels for this GPU, e.g. sm_90, and say what leaving out saves");
    command->add_flag("--json", arguments->json, "As JSON");
    return [arguments] { return run(arguments->scene, arguments->architecture, arguments->json); };
}

}  // namespace pt
