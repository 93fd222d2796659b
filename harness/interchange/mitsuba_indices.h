// Indices of refraction by the names that Mitsuba 3 has for them: of glass and fluids (include/mitsuba/render/ior.h)
// and, as its RGB variants have them, of metals (its data/ior/*.spd, integrated over the spectrum).
#pragma once

#include <optional>
#include <string>

#include "harness/scene/scene.h"

namespace pt {

// The index of refraction of a material of Mitsuba's, by its name in small or capital letters; nothing where there is
// none.
std::optional<double> mitsuba_index_of(const std::string& name);
std::string names_of_mitsuba_indices();

struct MitsubaMetal {
    const char* name;
    Vec3d eta, k;
};

// Finds a metal of Mitsuba's; null where there is none of that name here (Mitsuba has more).
const MitsubaMetal* find_mitsuba_metal(const std::string& name);
std::string names_of_mitsuba_metals();

}  // namespace pt
