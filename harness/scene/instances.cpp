#include "harness/scene/instances.h"

#include <cmath>

#include "harness/mesh/exact_math.h"

namespace pt {

namespace {

constexpr std::uint32_t most_levels = 5;  // limit on a sphereflake's levels; with 5 it has 66,430 spheres
constexpr std::uint32_t most_side = 512;

// Rotates a vector by the shortest rotation that takes +z to `direction`.
Vec3d turned_from_z(const Vec3d& v, const Vec3d& direction) {
    if (!(direction.z > -1 + 1e-12)) {
        return {v.x, -v.y, -v.z};
    }
    const Vec3d axis(-direction.y, direction.x, 0);
    const Vec3d across = cross(axis, v);
    return v + across + cross(axis, across) / (1 + direction.z);
}

// Directions from a sphere of the sphereflake to its nine children; +z points away from the sphere's parent.
std::vector<Vec3d> directions_of_children() {
    std::vector<Vec3d> directions;
    const auto add = [&](double degrees, double level, double height) {
        const SineCosine angle = exact_sine_cosine(degrees * (exact_pi / 180));
        directions.emplace_back(level * angle.cosine, level * angle.sine, height);
    };
    for (int i = 0; i < 6; ++i) {
        add(15 + 60 * i, 1, 0);
    }
    for (int i = 0; i < 3; ++i) {
        add(45 + 120 * i, std::sqrt(1.0 / 3), std::sqrt(2.0 / 3));
    }
    return directions;
}

struct Grown {
    Copy copy;
    Vec3d direction;  // direction from the parent sphere to this one, with z up
};

}  // namespace

std::vector<Copy> sphereflake(std::uint32_t levels) {
    const std::vector<Vec3d> children = directions_of_children();
    std::vector<Grown> all{{{}, {0, 0, 1}}};
    std::size_t first = 0;
    for (std::uint32_t level = 0; level < levels; ++level) {
        const std::size_t end = all.size();
        for (; first < end; ++first) {
            const Grown parent = all[first];
            const double scale = parent.copy.scale / 3;
            for (const Vec3d& child : children) {
                const Vec3d turned = turned_from_z(child, parent.direction);
                const Vec3d direction = turned / std::sqrt(dot(turned, turned));
                all.push_back({{parent.copy.offset + direction * (parent.copy.scale + scale), scale, 0}, direction});
            }
        }
    }
    std::vector<Copy> copies;
    for (const Grown& sphere : all) {
        const Vec3d& p = sphere.copy.offset;
        copies.push_back({{p.x, p.z, -p.y}, sphere.copy.scale, 0});
    }
    return copies;
}

std::vector<Copy> field(std::uint32_t side, double spacing, std::uint64_t seed) {
    MeshRandom random(seed);
    std::vector<Copy> copies;
    const double middle = 0.5 * (side - 1.0);
    for (std::uint32_t z = 0; z < side; ++z) {
        for (std::uint32_t x = 0; x < side; ++x) {
            copies.push_back({{spacing * (x - middle), 0, spacing * (z - middle)}, 1, random.uniform(0, 360)});
        }
    }
    return copies;
}

std::vector<Copy> read_instances(const JsonValue& value, double scale) {
    const bool is_field = value.json().is_object() && value.json().value("generate", Json()) == "field";
    const JsonObject rule(value, is_field ? std::vector<std::string>{"generate", "side", "spacing", "seed"}
                                          : std::vector<std::string>{"generate", "levels"});
    rule.required("generate").one_of({"sphereflake", "field"});
    if (is_field) {
        const auto side = static_cast<std::uint32_t>(
            rule.required("side").whole(1, most_side, fmt::format("a whole number from 1 to {}", most_side)));
        const double spacing = rule.required("spacing").number(1e-18, 1e15, "a number from 1e-18 to 1e15");
        const long long seed =
            rule.has("seed") ? rule.at("seed").whole(0, 1000000000, "a whole number from 0 to 1000000000") : 0;
        return field(side, spacing, static_cast<std::uint64_t>(seed));
    }
    std::vector<Copy> copies = sphereflake(static_cast<std::uint32_t>(
        rule.required("levels").whole(0, most_levels, fmt::format("a whole number from 0 to {}", most_levels))));
    for (Copy& copy : copies) {
        copy.offset = copy.offset * scale;
    }
    return copies;
}

SceneObject copied(const SceneObject& object, const Copy& copy) {
    SceneObject made = object;
    made.translate = object.translate + copy.offset;
    made.scale = object.scale * copy.scale;
    made.rotate_degrees.y += copy.turn_degrees;
    return made;
}

}  // namespace pt
