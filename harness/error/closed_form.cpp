#include "harness/error/closed_form.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/scene/material_kind.h"

namespace pt {

namespace {

// A point of the image in pixels, x to the right and y down from the upper left corner.
struct ImagePoint {
    double x, y;
};
using Polygon = std::vector<ImagePoint>;

// Clips a convex polygon to the half plane where `distance`, a linear function of the point, is not negative.
// Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
template <class Distance>
Polygon clipped(const Polygon& polygon, const Distance& distance) {
    Polygon inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const ImagePoint& a = polygon[i];
        const ImagePoint& b = polygon[(i + 1) % polygon.size()];
        const double da = distance(a);
        const double db = distance(b);
        if (da >= 0) {
            inside.push_back(a);
        }
        if ((da < 0) != (db < 0)) {
            const double t = da / (da - db);
            inside.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
        }
    }
    return inside;
}

// The area of a polygon, computed relative to its first corner to avoid cancellation far from the origin.
double area(const Polygon& polygon) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const ImagePoint& o = polygon[0];
        twice += (polygon[i].x - o.x) * (polygon[i + 1].y - o.y) - (polygon[i + 1].x - o.x) * (polygon[i].y - o.y);
    }
    return 0.5 * std::abs(twice);
}

double covered_area(const Polygon& polygon, double x, double y) {
    Polygon part = clipped(polygon, [&](const ImagePoint& p) { return p.x - x; });
    part = clipped(part, [&](const ImagePoint& p) { return x + 1 - p.x; });
    part = clipped(part, [&](const ImagePoint& p) { return p.y - y; });
    return area(clipped(part, [&](const ImagePoint& p) { return y + 1 - p.y; }));
}

bool covers_point(const Polygon& polygon, const ImagePoint& p) {
    bool positive = true;
    bool negative = true;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const ImagePoint& a = polygon[i];
        const ImagePoint& b = polygon[(i + 1) % polygon.size()];
        const double side = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        positive = positive && side >= 0;
        negative = negative && side <= 0;
    }
    return positive || negative;
}

// Projects a quad's corners to the image plane; none if a corner is not in front of the camera.
std::optional<Polygon> projected(const Scene& scene, const SceneObject& quad, const RenderSettings& settings) {
    const SceneCamera& camera = scene.camera;
    const Vec3d forward = normalize(camera.look_at - camera.eye);
    const Vec3d right = normalize(cross(forward, camera.up));
    const Vec3d up = cross(right, forward);
    const double half_angle = camera.vertical_fov_degrees * (std::acos(-1.0) / 360);
    const double pixel_size = 2 * std::tan(half_angle) / settings.height;
    const Rotation rotation = rotation_of(quad.rotate_degrees);
    Polygon polygon;
    for (const auto& [x, z] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        const Vec3d corner = quad.translate - camera.eye + rotation.column[0] * (x * quad.scale.x) +
                             rotation.column[2] * (z * quad.scale.z);
        const double depth = dot(corner, forward);
        if (depth <= 0) {
            return std::nullopt;
        }
        polygon.push_back({0.5 * settings.width + dot(corner, right) / (depth * pixel_size),
                           0.5 * settings.height - dot(corner, up) / (depth * pixel_size)});
    }
    return polygon;
}

std::optional<ClosedForm> of_lit_quad(const Scene& scene, const RenderSettings& settings) {
    const SceneObject& quad = scene.objects.front();
    const SceneMaterial& material = scene.materials[quad.material];
    const bool is_still = quad.velocity == Vec3d(0.0) || scene.camera.shutter_open == scene.camera.shutter_close;
    if (quad.shape != Shape::quad || !has_trait(material.type, material_trait::ends_paths) || !is_still ||
        scene.camera.aperture_radius != 0) {
        return std::nullopt;
    }
    const std::optional<Polygon> polygon = projected(scene, quad, settings);
    if (!polygon) {
        return std::nullopt;
    }
    ClosedForm form;
    form.formula = scene.camera.jitter
                       ? "radiance * c + environment * (1 - c), c: area of the quad's image within the pixel"
                       : "radiance if the quad's image covers the pixel's centre, environment otherwise";
    for (std::uint32_t y = 0; y < settings.height; ++y) {
        for (std::uint32_t x = 0; x < settings.width; ++x) {
            const double c = scene.camera.jitter ? std::min(1.0, covered_area(*polygon, x, y))
                                                 : (covers_point(*polygon, {x + 0.5, y + 0.5}) ? 1.0 : 0.0);
            for (int channel = 0; channel < 3; ++channel) {
                form.image.push_back(material.emission[channel] * c + scene.environment[channel] * (1 - c));
            }
        }
    }
    return form;
}

std::optional<ClosedForm> of_furnace(const Scene& scene, const RenderSettings& settings) {
    const SceneObject& object = scene.objects.front();
    const SceneMaterial& material = scene.materials[object.material];
    const std::optional<Vec3d> reflected = kind_of(material).even_reflectance(material);
    const bool can_move = object.velocity != Vec3d(0.0) || scene.camera.aperture_radius != 0;
    if (!reflected || shows_images(material) || can_move || has_shading_normals(scene, object) ||
        !contains_point(scene, object, scene.camera.eye)) {
        return std::nullopt;
    }
    ClosedForm form;
    form.formula = fmt::format("emission * (1 + a + ... + a^{}), a: albedo", settings.depth - 1);
    double sum[3];
    for (int channel = 0; channel < 3; ++channel) {
        const double a = (*reflected)[channel];
        const double series =
            a == 1 ? settings.depth : (1 - std::pow(a, static_cast<double>(settings.depth))) / (1 - a);
        sum[channel] = material.emission[channel] * series;
    }
    for (std::uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
        form.image.insert(form.image.end(), std::begin(sum), std::end(sum));
    }
    return form;
}

}  // namespace

std::optional<ClosedForm> closed_form(const Scene& scene, const RenderSettings& settings) {
    if (scene.objects.size() != 1 || scene.environment_map != nullptr) {
        return std::nullopt;
    }
    std::optional<ClosedForm> form = of_lit_quad(scene, settings);
    return form ? form : of_furnace(scene, settings);
}

}  // namespace pt
