#include "harness/cli/list_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/known_names.h"
#include "harness/scene/places.h"
#include "variants/registry.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

std::string text_in(const OrderedJson& json, const char* key) { return json.at(key).get<std::string>(); }

std::string joined(const OrderedJson& names, const char* between) {
    return fmt::format("{}", fmt::join(names.get<std::vector<std::string>>(), between));
}

// Joins words with spaces into lines of at most 120 columns.
std::string wrapped(const std::vector<std::string>& words) {
    constexpr std::size_t width = 120;
    std::string text, line = " ";
    for (const std::string& word : words) {
        if (line.size() + 1 + word.size() > width) {
            text += line + "\n";
            line = " ";
        }
        line += " " + word;
    }
    return text + line + "\n";
}

bool is_there(std::string_view axis, const std::string& choice, Backend backend) {
    return Registry::instance().find(axis, choice, backend) != nullptr;
}

// The name of a choice, followed by * if only CUDA has it and by ' if only the CPU has it.
std::string marked(std::string_view axis, const std::string& choice) {
    if (!is_there(axis, choice, Backend::cpu)) {
        return choice + "*";
    }
    const bool is_common = is_there(axis, choice, Backend::cuda);
    const bool has_cuda = !Registry::instance().choices(axis, Backend::cuda).empty();
    return is_common || !has_cuda ? choice : choice + "'";
}

std::string tunable_text(const OrderedJson& t) {
    const auto multiple = t.at("multiple_of").get<std::uint32_t>();
    return fmt::format("    tunable {}={} ({} to {}{}): {}\n", text_in(t, "name"),
                       t.at("default_value").get<std::uint32_t>(), t.at("lowest").get<std::uint32_t>(),
                       t.at("highest").get<std::uint32_t>(),
                       multiple == 1 ? "" : fmt::format(", multiples of {}", multiple), text_in(t, "summary"));
}

std::string kernels_text(const OrderedJson& kernels) {
    std::string text;
    for (const OrderedJson& kernel : kernels) {
        text += fmt::format("  {:<26}   megakernel {} for {}: {} registers, {} bytes of code", "",
                            text_in(kernel, "specialisation"), text_in(kernel, "architecture"),
                            kernel["registers"].get<int>(), kernel["code_bytes"].get<std::size_t>());
        if (kernel.contains("instructions")) {
            text += fmt::format(", {} instructions", kernel["instructions"]["total"].get<std::size_t>());
        }
        text += "\n";
    }
    return text;
}

}  // namespace

std::string overview_text() {
    std::string text = "Axes and choices, the first one the baseline (* cuda only, ' cpu only)\n";
    for (const Axis& axis : axis_table) {
        std::vector<std::string> choices;
        for (const std::string& name : names_of_choices(axis.key)) {
            choices.push_back(marked(axis.key, name));
        }
        text += fmt::format("  {:<17} {}\n", axis.key, fmt::join(choices, " "));
    }
    text += "Scenes\n" + wrapped(scene_names()) + "Suites\n" + wrapped(suite_names()) + backends_text();
    return text +
           "More: ptbench list AXIS (claims, origins, tunables), list scenes, list suites; list --scene S: what "
           "applies "
           "there\n";
}

std::string axes_text() {
    std::string text = "Axes\n";
    for (const Axis& axis : axis_table) {
        text += fmt::format("  {:<20} {}\n", axis.key, axis.what);
    }
    return text;
}

std::string features_text() {
    std::string text = "Features\n";
    for (const std::string& name : feature_names(~no_features)) {
        text += fmt::format("  {}\n", name);
    }
    return text;
}

std::string axis_text(const OrderedJson& axis) {
    const std::string name = text_in(axis, "name");
    std::string text = fmt::format("{}: {}\n", name, axis_table[Variant::index(name)].what);
    for (const OrderedJson& choice : axis.at("choices")) {
        const std::string note = text_in(choice, "claim_note");
        const OrderedJson &backends = choice.at("backends"), &baseline_on = choice.at("baseline_on");
        const std::string where = baseline_on == backends ? "" : " on " + joined(baseline_on, " and ");
        text += fmt::format("  {}  ({}){}\n    {}\n    origin: {}\n    claim: {}{}\n", text_in(choice, "name"),
                            joined(backends, ", "), baseline_on.empty() ? "" : "  the baseline" + where,
                            text_in(choice, "summary"), text_in(choice, "origin"), text_in(choice, "claim"),
                            note.empty() ? "" : ": " + note);
        for (const OrderedJson& t : choice.at("tunables")) {
            text += tunable_text(t);
        }
    }
    return text;
}

std::string scenes_text(const OrderedJson& scenes) {
    std::string text = "Scenes\n";
    for (const OrderedJson& scene : scenes) {
        text += fmt::format("  {:<26} {}\n", text_in(scene, "name"), text_in(scene, "description"));
        text += fmt::format("  {:<26}   needs {}\n", "", joined(scene.at("features"), " "));
        for (const auto& [choice, reason] : scene.at("not_applicable").items()) {
            text += fmt::format("  {:<26}   n/a: {}\n", "", reason.get<std::string>());
        }
        text += fmt::format("  {:<26}   leaves out {}\n", "", joined(scene.at("left_out"), " "));
        text += scene.contains("kernels") ? kernels_text(scene.at("kernels")) : "";
    }
    return text;
}

std::string suites_text() {
    std::string text = "Suites\n";
    for (const std::string& name : suite_names()) {
        const OrderedJson suite = list_suite(name);
        text += fmt::format("  {:<16} {}\n", name, text_in(suite, "description"));
    }
    return text;
}

std::string backends_text() {
    std::string text = "Backends\n";
    for (const OrderedJson& backend : list_backends()) {
        text += fmt::format("  {:<26} {}\n", text_in(backend, "name"), text_in(backend, "status"));
    }
    return text;
}

}  // namespace pt
