// The names of a variant, and its identity. A name has the integrator and what differs from the baseline, so it changes
// where a baseline does; the identity, a hash of all choices and tunables, does not.
#pragma once

#include <string>

#include "variants/descriptor.h"

namespace pt {

// The name of a variant as people see it, "wavefront compaction=thrust_remove_if layout=soa jitters=4": the integrator,
// the axes that are not at the backend's baseline, and the tunables that are not at their default.
std::string shown_name(const Variant& variant, Backend backend);

// The variant as the beginning of a benchmark's name: "wavefront/compaction:thrust_remove_if/layout:soa/jitters:4".
std::string benchmark_name(const Variant& variant, Backend backend);

// The identity of a variant: a hash of every choice and tunable, as 16 hexadecimal digits. An axis or tunable that was
// added later is left out at the value that stands for its absence (Axis::as_before, Tunable::as_before).
std::string variant_id(const Variant& variant, Backend backend);

}  // namespace pt
