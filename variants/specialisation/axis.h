// The axis `specialisation`: what of a kernel is left out for a scene.
#pragma once

#include "variants/axis.h"

namespace pt {

struct SpecialisationTraits {
    bool is_generic = false;  // one kernel for every scene
    bool by_matrix = false;   // every object is intersected through its matrix, by other code than in kernels/
};

namespace specialisation {

using Traits = SpecialisationTraits;
inline constexpr Axis axis_facts{
    .what = "what of a kernel is left out for a scene",
    .order = 100,
};

}  // namespace specialisation
}  // namespace pt
