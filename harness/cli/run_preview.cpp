#include "harness/cli/run_preview.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/known_names.h"
#include "harness/json_reader.h"
#include "harness/scene/places.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// Whether the suite names scenes with meshes; checked in the text, since loading large meshes takes seconds.
bool has_scenes_with_meshes(const std::string& suite_file) {
    const Json suite = parse_loosely(suite_file);
    for (const Json& study : array_in(suite, "studies")) {
        for (const Json& scene : array_in(study, "scenes")) {
            if (scene.is_string() && names_meshes(scene.get<std::string>())) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

std::string what_run_compares(Backend backend) {
    std::string text = fmt::format("On {}, --scene S --axis AXIS=all compares\n", to_string(backend));
    for (const std::string_view axis : axis_names) {
        const std::vector<std::string> choices = names_of_choices(axis, static_cast<BackendSet>(backend));
        if (choices.size() > 1) {
            text += fmt::format("  {:<17} {}\n", axis, fmt::join(choices, " "));
        }
    }
    text += "and --suite NAME\n";
    for (const std::string& name : suite_names()) {
        const std::string file = find_suite_file(name);
        if (has_scenes_with_meshes(file)) {
            text += fmt::format("  {:<17} scenes with meshes: --dry-run reads them and counts the cells\n", name);
            continue;
        }
        const Suite suite = load_suite(file);
        const std::size_t cells = make_plan(suite, backend).cells.size();
        text += fmt::format("  {:<17} {:>3} cells, {:>4} samples\n", name, cells,
                            cells * static_cast<std::size_t>(suite.repetitions));
    }
    return text +
           "For instance\n"
           "  ptbench run --scene cornell_open,cornell_closed --axis compaction=all\n"
           "  ptbench run --suite quick\n"
           "With --dry-run it lists the cells and runs nothing.\n";
}

std::string nothing_to_compare(const Plan& plan) {
    const auto is_other = [&](const Cell& cell) { return cell.variant != plan.cells.front().variant; };
    if (std::any_of(plan.cells.begin(), plan.cells.end(), is_other)) {
        return "";
    }
    const Cell& cell = plan.cells.front();
    return fmt::format(
        "one variant, {}, compared with nothing; --axis AXIS=all compares choices (`ptbench run` alone says of which "
        "axes)\n",
        shown_name(cell.variant, cell.backend));
}

}  // namespace pt
