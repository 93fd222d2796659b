// Writes a variant as JSON in the form that result files hold.
#pragma once

#include <nlohmann/json.hpp>

#include "variants/descriptor.h"

namespace pt {

// A variant's choices by axis, in the order of the axes.
nlohmann::ordered_json axes_json(const Variant& variant);

}  // namespace pt
