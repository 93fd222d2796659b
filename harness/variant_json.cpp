#include "harness/variant_json.h"

#include "variants/variant_name.h"

namespace pt {

nlohmann::ordered_json axes_json(const Variant& variant) {
    nlohmann::ordered_json axes;
    for (const std::string_view axis : axis_names) {
        axes[std::string(axis)] = variant[axis];
    }
    return axes;
}

nlohmann::ordered_json variant_json(const Variant& variant, Backend backend) {
    return {{"variant", shown_name(variant, backend)},
            {"variant_id", variant_id(variant, backend)},
            {"axes", axes_json(variant)}};
}

}  // namespace pt
