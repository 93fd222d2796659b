// Suites: what to run, and the cells that follow from it. A cell is scene x backend x variant x settings.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/render/renderer.h"

namespace pt {

// Choices by axis; an axis that is not named stays at its baseline.
using AxisChoices = std::map<std::string, std::vector<std::string>>;

struct Study {
    std::string name;
    std::string title;
    // Which figure analysis draws from it: one by name, or an axis whose choices are compared; empty: none.
    std::string figure;
    std::vector<std::string> scenes;
    AxisChoices axes;
    std::uint32_t width = 0, height = 0;  // 0: the scene's own
    std::vector<std::uint32_t> depths;    // empty: the scene's own
    std::uint32_t spp = 1;
};

struct Suite {
    std::string name;
    std::string description;
    int repetitions = 9;
    std::vector<Study> studies;
};

struct Cell {
    std::string name;  // VARIANT/scene:NAME/backend:cpu/resolution:WxH/depth:D/spp:N
    std::vector<std::string> studies;
    std::shared_ptr<const Scene> scene;
    Variant variant;
    RenderSettings settings;
    std::uint32_t spp = 1;
};

struct NotApplicable {
    std::string study;
    std::string scene;
    Variant variant;
    std::string reason;
};

struct Plan {
    std::vector<Cell> cells;  // each name once
    std::vector<NotApplicable> not_applicable;
};

// Throws InputError.
Suite load_suite(const std::string& file);
// Loads the scenes; throws InputError for an unknown scene, axis or choice.
Plan make_plan(const Suite& suite);

// Every variant of the product of the given choices; unnamed axes at their baseline.
std::vector<Variant> expand(const AxisChoices& axes);
// Every choice of every axis.
AxisChoices all_choices();
// "NAME=c1,c2" -> adds to `axes`; throws InputError with the allowed names.
void add_axis_argument(AxisChoices& axes, const std::string& argument);
void check_choices(const AxisChoices& axes, const std::string& file, const std::string& place);

}  // namespace pt
