#include "harness/interchange/mitsuba_indices.h"

#include <algorithm>
#include <iterator>

#include "harness/words.h"

namespace pt {

namespace {

struct MitsubaIndex {
    const char* name;
    double value;
};

constexpr MitsubaIndex mitsuba_indices[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

// Complex indices of metals for red, green and blue, printed by Mitsuba 3.9.1 in its variant scalar_rgb:
// traverse(load_dict({"type": "conductor", "material": NAME})).
const MitsubaMetal mitsuba_metals[] = {
    {"Ag", {0.1552762, 0.116728, 0.1383876}, {4.828354, 3.122222, 2.146901}},
    {"Al", {1.657501, 0.8804047, 0.5212445}, {9.223811, 6.269502, 4.837004}},
    {"Au", {0.143036, 0.3753071, 1.442045}, {3.982997, 2.385556, 1.603359}},
    {"Be", {4.185012, 3.185029, 2.784061}, {3.835466, 3.010122, 2.868994}},
    {"Cr", {4.369668, 2.916505, 1.654905}, {5.206547, 4.231306, 3.754699}},
    {"Cu", {0.2010055, 0.9237495, 1.102215}, {3.913262, 2.453045, 2.14209}},
    {"Hg", {2.398939, 1.440028, 0.9095704}, {6.327587, 4.371925, 3.421764}},
    {"Ir", {3.0863, 2.082191, 1.617915}, {5.592153, 4.067088, 3.267312}},
    {"Li", {0.2657909, 0.1956183, 0.2209486}, {3.540155, 2.311123, 1.668607}},
    {"Mo", {4.483974, 3.525131, 2.77631}, {4.111437, 3.420827, 3.150607}},
    {"Ta", {2.062721, 2.392939, 2.627929}, {2.40836, 1.741486, 1.947028}},
    {"TiN", {1.64845, 1.150516, 1.379823}, {3.368328, 1.943498, 1.102068}},
    {"W", {4.370817, 3.300246, 2.998407}, {3.500641, 2.604874, 2.273233}},
};

template <class Table>
std::string names_in(const Table& table) {
    std::string names;
    for (const auto& entry : table) {
        names += (names.empty() ? "" : ", ") + std::string(entry.name);
    }
    return names;
}

}  // namespace

std::optional<double> mitsuba_index_of(const std::string& name) {
    const std::string small = in_lower_case(name);
    const auto* found = std::find_if(std::begin(mitsuba_indices), std::end(mitsuba_indices),
                                     [&](const MitsubaIndex& index) { return small == index.name; });
    return found == std::end(mitsuba_indices) ? std::nullopt : std::optional(found->value);
}

std::string names_of_mitsuba_indices() { return names_in(mitsuba_indices); }

const MitsubaMetal* find_mitsuba_metal(const std::string& name) {
    const auto* found = std::find_if(std::begin(mitsuba_metals), std::end(mitsuba_metals),
                                     [&](const MitsubaMetal& metal) { return name == metal.name; });
    return found == std::end(mitsuba_metals) ? nullptr : found;
}

std::string names_of_mitsuba_metals() { return names_in(mitsuba_metals); }

}  // namespace pt
