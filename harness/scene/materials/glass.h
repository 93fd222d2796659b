// Shared by smooth and rough glass: reading from scene files and packing for kernels.
#pragma once

#include "harness/scene/material_kind.h"
#include "harness/scene/scene_texture.h"

namespace pt {

template <class Real>
DielectricMaterial<Real> packed_glass(const SceneMaterial& material) {
    return {narrow<Real>(material.tint), entering_boundary<Real>(material.ior), leaving_boundary<Real>(material.ior)};
}

// Reads the keys of glass: "ior", and optionally "tint", "sigma_a" and "normal".
inline SceneMaterial read_glass(const JsonObject& object) {
    SceneMaterial material;
    material.ior = read_ior(object.required("ior"));
    material.tint = object.has("tint") ? read_fractions(object.at("tint")) : Vec3d(1.0);
    material.sigma_a = object.has("sigma_a") ? read_sigma(object.at("sigma_a")) : Vec3d(0.0);
    read_normal_map(object, material);
    return material;
}

// The functions of a MaterialKind that smooth and rough glass share.
inline MaterialKind glass_kind() {
    MaterialKind kind;
    kind.extra_features = [](const SceneMaterial& m) {
        return is_black(m.sigma_a) ? no_features : no_features | Feature::absorption;
    };
    kind.first_hit_albedo = [](const SceneMaterial& m, const Vec3d&) { return m.tint; };
    kind.needs_inside = [](const SceneMaterial&) { return true; };
    return kind;
}

}  // namespace pt
