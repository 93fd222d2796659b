// The axis `specialisation`: what of a kernel is left out for a scene.
#pragma once

#include "variants/axis.h"

namespace pt {

struct SpecialisationTraits {
    bool is_generic = false;  // one kernel serves every scene
    bool by_matrix = false;   // kernels intersect every object through its matrix (kernels/transform.h), by other code
};

namespace specialisation {

using Traits = SpecialisationTraits;
inline constexpr Axis axis_facts{
    .what = "what of a kernel is left out for a scene",
    .order = 100,
};

}  // namespace specialisation
}  // namespace pt
