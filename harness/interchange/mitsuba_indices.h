// Named indices of refraction of Mitsuba 3: dielectrics (include/mitsuba/render/ior.h), and metals as its RGB variants
// have them (data/ior/*.spd, integrated over the spectrum).
#pragma once

#include <optional>
#include <string>

#include "harness/scene/scene.h"

namespace pt {

// Index of refraction of a dielectric by Mitsuba's name, in lower or upper case; nothing if unknown.
std::optional<double> mitsuba_index_of(const std::string& name);
std::string names_of_mitsuba_indices();

struct MitsubaMetal {
    const char* name;
    Vec3d eta, k;
};

// Finds a metal by Mitsuba's name; null if unknown (Mitsuba has more than this table).
const MitsubaMetal* find_mitsuba_metal(const std::string& name);
std::string names_of_mitsuba_metals();

}  // namespace pt
