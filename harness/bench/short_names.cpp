#include "harness/bench/short_names.h"

#include <fmt/format.h>

#include "variants/variant_name.h"

namespace pt {

ShortNames::ShortNames(const Plan& plan) {
    for (const Cell& cell : plan.cells) {
        const RenderSettings &one = plan.cells.front().settings, &other = cell.settings;
        sizes_differ_ = sizes_differ_ || one.width != other.width || one.height != other.height;
        depths_differ_ = depths_differ_ || one.depth != other.depth;
        spps_differ_ = spps_differ_ || plan.cells.front().spp != cell.spp;
    }
}

std::string ShortNames::of(const Cell& cell) const {
    std::string name = fmt::format("{}, {}", shown_name(cell.variant, cell.backend), cell.scene->name);
    name += sizes_differ_ ? fmt::format(", {}x{}", cell.settings.width, cell.settings.height) : "";
    name += depths_differ_ ? fmt::format(", depth {}", cell.settings.depth) : "";
    return name + (spps_differ_ ? fmt::format(", {} spp", cell.spp) : "");
}

}  // namespace pt
