#include "harness/cli/list_json.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/cli/known_names.h"
#include "harness/cuda/backend.h"
#include "harness/scene/places.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

// Whether the backend has choices on every axis; a build without a CUDA toolkit lacks some.
bool is_built(Backend backend) {
    return std::all_of(std::begin(axis_names), std::end(axis_names),
                       [&](std::string_view axis) { return !Registry::instance().choices(axis, backend).empty(); });
}

// A choice as `list --json` shows it: one object for all backends; claim and summary are those of the first backend.
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

// For each backend and choice, why the choice does not apply to the scene with all other axes at the baseline.
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

std::string cuda_status() {
    const std::string reason = cuda::not_available();
    return reason.empty() ? "available: " + cuda::machine_name() : "not available (" + reason + ")";
}

}  // namespace

OrderedJson list_axis_facts() {
    OrderedJson axes = OrderedJson::array();
    for (const Axis& axis : axis_table) {
        OrderedJson facts{{"name", axis.key}, {"what", axis.what}};
        if (!axis.since.empty()) {
            facts["since"] = axis.since;
            facts["as_before"] = axis.as_before;
        }
        facts["decides_error"] = axis.decides_error;
        facts["decides_samples"] = axis.decides_samples;
        axes.push_back(facts);
    }
    return axes;
}

OrderedJson list_features() { return feature_names(~no_features); }

OrderedJson list_axis(std::string_view axis) {
    OrderedJson choices = OrderedJson::array();
    for (const std::string& name : names_of_choices(axis)) {
        choices.push_back(choice_json(axis, name));
    }
    return {{"name", axis}, {"choices", choices}};
}

OrderedJson list_axes() {
    OrderedJson axes = OrderedJson::array();
    for (const std::string_view axis : axis_names) {
        axes.push_back(list_axis(axis));
    }
    return axes;
}

OrderedJson list_scene(const std::string& name) {
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

OrderedJson list_kernels(const std::string& name, const std::string& architecture) {
    const Scene scene = find_scene(name);
    OrderedJson kernels = OrderedJson::array();
    for (const Choice* choice : Registry::instance().choices(axes::specialisation, Backend::cuda)) {
        Variant variant = Registry::instance().baseline(Backend::cuda);
        variant.set(axes::integrator, "megakernel");
        variant.set(axes::specialisation, std::string(choice->descriptor.name));
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

OrderedJson list_suite(const std::string& name) {
    const Suite suite = load_suite(find_suite_file(name));
    return {{"name", suite.name},
            {"description", suite.description},
            {"repetitions", suite.repetitions},
            {"studies", suite.studies.size()}};
}

OrderedJson list_backends() {
    return {{{"name", "cpu"}, {"status", "available"}}, {{"name", "cuda"}, {"status", cuda_status()}}};
}

}  // namespace pt
