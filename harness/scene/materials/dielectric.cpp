// Material kind `dielectric`: smooth glass.
#include "harness/scene/materials/glass.h"

namespace pt {

MaterialKind kind_of_dielectric() {
    MaterialKind kind = glass_kind();
    kind.read = [](const JsonValue& value) {
        return read_glass(JsonObject(value, {"type", "ior", "tint", "sigma_a", "normal"}));
    };
    kind.set_pack(
        []<class Real>(const SceneMaterial& m, Material<Real>& packed) { packed.dielectric = packed_glass<Real>(m); });
    kind.in_mitsuba = [](const SceneMaterial& m) { return MitsubaBsdf{MitsubaBsdf::Type::dielectric, m.tint}; };
    return kind;
}

}  // namespace pt
