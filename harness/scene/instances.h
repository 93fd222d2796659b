// Generates many copies of one object by a rule: {"generate": "sphereflake", "levels": 3} in a scene file makes 820.
#pragma once

#include <vector>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// Position, rotation and scale of a copy of an object.
struct Copy {
    Vec3d offset{0.0};        // position of a copy relative to the original object
    double scale = 1;         // scale of a copy relative to the original object
    double turn_degrees = 0;  // rotation of a copy about y, added to the original object's
};

// Reads the key "instances" of an object, whose scale is a sphereflake's unit of length. Throws InputError.
std::vector<Copy> read_instances(const JsonValue& value, double scale);

// Copies that form a sphereflake: a sphere of radius 1 carries nine of a third of its radius, each of which carries
// nine, `levels` times over. Six stand round the equator and three above, as seen from the parent sphere. Haines, "A
// Proposal for Standard Graphics Environments", IEEE CG&A 7 (11), 1987.
std::vector<Copy> sphereflake(std::uint32_t levels);

// Copies on a side x side grid in the plane y = 0, `spacing` apart, each rotated about y by a random angle.
std::vector<Copy> field(std::uint32_t side, double spacing, std::uint64_t seed);

SceneObject copied(const SceneObject& object, const Copy& copy);

}  // namespace pt
