#include "harness/variant_json.h"

namespace pt {

nlohmann::ordered_json axes_json(const Variant& variant) {
    nlohmann::ordered_json axes;
    for (const std::string_view axis : axis_names) {
        axes[std::string(axis)] = variant[axis];
    }
    return axes;
}

}  // namespace pt
