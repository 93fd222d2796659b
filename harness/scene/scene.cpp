#include "harness/scene/scene.h"

#include "harness/scene/material_kind.h"
#include "harness/scene/scene_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pt {

namespace {

struct SinCosDegrees {
    double sine, cosine;
};

// Sine and cosine of an angle in degrees, exact at multiples of 90 so that a rotated box stays axis-aligned.
SinCosDegrees sin_cos_degrees(double degrees) {
    const double reduced = std::fmod(degrees, 360.0);
    const double quarters = reduced / 90.0;
    if (quarters == std::floor(quarters)) {
        static constexpr double sines[] = {0, 1, 0, -1};
        const int quarter = (static_cast<int>(quarters) % 4 + 4) % 4;
        return {sines[quarter], sines[(quarter + 1) % 4]};
    }
    const double radians = reduced * (pi<double> / 180.0);
    return {std::sin(radians), std::cos(radians)};
}

bool is_quarter_turn(double degrees) { return std::fmod(degrees, 90.0) == 0.0; }

}  // namespace

Rotation rotation_of(const Vec3d& degrees) {
    const SinCosDegrees x = sin_cos_degrees(degrees.x);
    const SinCosDegrees y = sin_cos_degrees(degrees.y);
    const SinCosDegrees z = sin_cos_degrees(degrees.z);
    // Columns of the rotation matrix Rz Ry Rx.
    return {{{z.cosine * y.cosine, z.sine * y.cosine, -y.sine},
             {z.cosine * y.sine * x.sine - z.sine * x.cosine, z.sine * y.sine * x.sine + z.cosine * x.cosine,
              y.cosine * x.sine},
             {z.cosine * y.sine * x.cosine + z.sine * x.sine, z.sine * y.sine * x.cosine - z.cosine * x.sine,
              y.cosine * x.cosine}}};
}

namespace {

// Calls visit(kind, shape) for every kind of shape, in the list's order; `shape` only gives access to static members.
template <class Visit>
void for_each_kind(const Visit& visit) {
#define PT_VISIT_KIND(name, array, Type) visit(ShapeKind::name, Type<double>{});
    PT_SHAPES(PT_VISIT_KIND)
#undef PT_VISIT_KIND
}

template <class Visit>
void visit_kind(ShapeKind wanted, const Visit& visit) {
    for_each_kind([&](ShapeKind kind, const auto& shape) {
        if (kind == wanted) {
            visit(shape);
        }
    });
}

}  // namespace

std::string name_of(Shape shape) {
    std::string name;
    visit_kind(shape.first_kind, [&](const auto& kind) { name = kind.file_name; });
    return name;
}

std::vector<std::string> shape_names() {
    std::vector<std::string> names;
    for_each_kind([&](ShapeKind, const auto& shape) {
        if (std::find(names.begin(), names.end(), shape.file_name) == names.end()) {
            names.emplace_back(shape.file_name);
        }
    });
    return names;
}

Shape shape_named(const std::string& name) {
    std::optional<Shape> found;
    for_each_kind([&](ShapeKind kind, const auto& shape) {
        if (!found && shape.file_name == name) {
            found = Shape{kind};
        }
    });
    return found.value();
}

Placement placement_of(const SceneObject& object, const Vec3d& eye) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    const Vec3d& r = object.rotate_degrees;
    return {object.translate - eye,
            {rotation.column[0], rotation.column[1], rotation.column[2]},
            object.scale,
            is_quarter_turn(r.x) && is_quarter_turn(r.y) && is_quarter_turn(r.z)};
}

ShapeKind classify(const SceneObject& object) {
    const std::string name = name_of(object.shape);
    const Placement placement = placement_of(object, Vec3d(0.0));
    std::optional<ShapeKind> found;
    for_each_kind([&](ShapeKind kind, const auto& shape) {
        if (!found && shape.file_name == name && shape.is_kind_of(placement)) {
            found = kind;
        }
    });
    return found.value();
}

bool is_flat(const SceneObject& object) {
    bool flat = false;
    visit_kind(object.shape.first_kind, [&](const auto& shape) { flat = shape.is_flat; });
    return flat;
}

bool contains_point(const Scene& scene, const SceneObject& object, const Vec3d& point) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    const Vec3d p = point - object.translate;
    const Vec3d local{dot(rotation.column[0], p) / object.scale.x, dot(rotation.column[1], p) / object.scale.y,
                      dot(rotation.column[2], p) / object.scale.z};
    if (object.mesh != SceneObject::no_mesh) {
        const SceneMesh& mesh = *scene.meshes[object.mesh];
        return mesh.is_closed && is_inside(mesh, local);
    }
    bool inside = false;
    visit_kind(object.shape.first_kind, [&](const auto& shape) { inside = shape.contains(local); });
    return inside;
}

namespace {

// The rounding error of a floating-point sum: Knuth's two-sum.
double lost_in_sum(double a, double b, double sum) {
    const double b_in_sum = sum - a;
    return (a - (sum - b_in_sum)) + (b - b_in_sum);
}

// Dot product with twice the precision of a double: Ogita, Rump and Oishi, "Accurate Sum and Dot Product", SIAM J. Sci.
// Comput. 26(6), 2005.
class DoubledSum {
public:
    void add_product(double a, double b) {
        const double product = a * b;
        error_ += std::fma(a, b, -product);
        add(product);
    }
    double value() const { return sum_ + error_; }

private:
    void add(double term) {
        const double sum = sum_ + term;
        error_ += lost_in_sum(sum_, term, sum);
        sum_ = sum;
    }

    double sum_ = 0, error_ = 0;
};

}  // namespace

double eye_power(const SceneObject& sphere, const Vec3d& eye) {
    // Sphere and eye are scaled by a power of two near 1 / radius, so that squares neither overflow nor vanish.
    int exponent = 0;
    const double radius = std::frexp(0.5 * sphere.scale.x, &exponent);
    DoubledSum sum;
    for (int axis = 0; axis < 3; ++axis) {
        const double place = std::ldexp(sphere.translate[axis], -exponent);
        const double seen_from = std::ldexp(eye[axis], -exponent);
        const double offset = place - seen_from;
        const double rest = lost_in_sum(place, -seen_from, offset);
        sum.add_product(offset, offset);
        sum.add_product(2 * offset, rest);
        sum.add_product(rest, rest);
    }
    sum.add_product(-radius, radius);
    return sum.value() / (radius * radius);
}

bool is_near_eye(const SceneObject& object, const Vec3d& eye) {
    return classify(object) == ShapeKind::sphere && std::abs(eye_power(object, eye)) < 0.5;
}

bool lets_light_in(const SceneMaterial& material) {
    return kind_of(material).needs_inside(material) && !has_trait(material.type, material_trait::has_walks);
}

bool shows_images(const SceneMaterial& material) {
    return material.texture != nullptr || material.roughness_texture != nullptr || material.normal_texture != nullptr;
}

bool has_textures(const Scene& scene) {
    return std::any_of(scene.objects.begin(), scene.objects.end(),
                       [&](const SceneObject& object) { return shows_images(scene.materials[object.material]); });
}

bool has_shading_normals(const Scene& scene, const SceneObject& object) {
    const SceneMaterial& material = scene.materials[object.material];
    return material.normal_texture != nullptr ||
           (object.shading_normals && !has_trait(material.type, material_trait::ends_paths));
}

FeatureSet features_of(const Scene& scene) {
#define PT_FEATURE(name, array, Type) Feature::name,
    static constexpr Feature by_kind[] = {PT_SHAPES(PT_FEATURE)};
#undef PT_FEATURE
    const bool shutter_moves_objects = scene.camera.shutter_open != 0 || scene.camera.shutter_close != 0;
    FeatureSet features = no_features;
    for (const SceneObject& object : scene.objects) {
        const ShapeKind kind = classify(object);
        features = features | by_kind[static_cast<std::size_t>(kind)];
        features |= features_of(scene.materials[object.material]);
        if (kind == ShapeKind::sphere && is_near_eye(object, scene.camera.eye)) {
            features = features | Feature::near_sphere;
        }
        if (has_shading_normals(scene, object)) {
            features = features | Feature::shading_normals;
        }
        if (shutter_moves_objects && !is_black(object.velocity)) {
            features = features | Feature::motion;
        }
    }
    if (!is_black(scene.environment)) {
        features = features | Feature::environment;
    }
    if (scene.environment_map != nullptr) {
        features = features | Feature::environment_map;
    }
    if (has_textures(scene)) {
        features = features | Feature::textures;
    }
    if (scene.camera.jitter) {
        features = features | Feature::jitter;
    }
    if (scene.camera.aperture_radius > 0) {
        features = features | Feature::lens;
    }
    return features;
}

}  // namespace pt
