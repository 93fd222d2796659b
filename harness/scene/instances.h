// Many copies of one object by a rule: {"generate": "sphereflake", "levels": 3} in a scene's file stands for 820.
#pragma once

#include <vector>

#include "harness/json_reader.h"
#include "harness/scene/scene.h"

namespace pt {

// The place of a copy of an object, and how it is turned and scaled.
struct Copy {
    Vec3d offset{0.0};        // from the object's place
    double scale = 1;         // times the object's own
    double turn_degrees = 0;  // about y, added to the object's own
};

// The value of an object's key "instances"; `scale`: of the object, which is a sphereflake's unit of length. Throws
// InputError.
std::vector<Copy> read_instances(const JsonValue& value, double scale);

// A sphere of radius 1 with nine of a third of its radius on it, each of which has nine, `levels` times over: six round
// its equator, three above, seen from where it stands on its parent. Haines, "A Proposal for Standard Graphics
// Environments", IEEE CG&A 7 (11), 1987.
std::vector<Copy> sphereflake(std::uint32_t levels);

// The places of side x side copies in the plane y = 0 round the middle, `spacing` apart, each turned at random.
std::vector<Copy> field(std::uint32_t side, double spacing, std::uint64_t seed);

SceneObject copied(const SceneObject& object, const Copy& copy);

}  // namespace pt
