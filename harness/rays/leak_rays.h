// Rays from inside a closed mesh towards shared vertices and edges, or some ulps beside them, where rays may leak
// through. A seed and a ray's number determine the ray, bit for bit on host and device, so that it can be traced again
// anywhere. Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2 (1), 2013, section 4.2.
#pragma once

#include "harness/rays/ray_batch.h"

namespace pt::rays {

// A cube inside the mesh that no triangle intersects; rays start in such cubes.
struct InnerCube {
    float centre[3];
    float half;
};

struct LeakView {
    const Triangle<float>* triangles;
    const InnerCube* cubes;
    std::uint32_t triangle_count, cube_count;
    std::uint64_t seed;
};

inline constexpr const char* leak_classes[] = {"vertex",    "edge_middle", "edge_point", "near_vertex",
                                               "near_edge", "along_edge",  "axis_plane"};
inline constexpr std::uint32_t leak_class_count = std::size(leak_classes);
PT_HD inline std::uint32_t leak_class_of(std::uint64_t ray) { return static_cast<std::uint32_t>(ray % 7u); }
static_assert(leak_class_count == 7);

// SplitMix64 random numbers (Steele, Lea, Flood 2014), started from a hash of the seed and the ray's number.
class LeakRandom {
public:
    PT_HD LeakRandom(std::uint64_t seed, std::uint64_t ray) : state_(mixed(mixed(seed) ^ ray)) {}

    PT_HD std::uint32_t word() {
        state_ += 0x9e3779b97f4a7c15ull;
        return static_cast<std::uint32_t>(mixed(state_) >> 32);
    }
    PT_HD std::uint32_t below(std::uint32_t count) {
        return static_cast<std::uint32_t>((std::uint64_t{word()} * count) >> 32);
    }
    PT_HD float unit() { return static_cast<float>(word() >> 8) * 0x1p-24f; }  // a uniform random number in [0, 1)

private:
    PT_HD static std::uint64_t mixed(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

// Moves a float by a random number of ulps from -4 to 4; numbers within 2^-100 of 0 stay as they are.
PT_HD inline float nudged(float x, LeakRandom& random) {
    const std::int32_t by = static_cast<std::int32_t>(random.below(9)) - 4;
    return absolute(x) < 0x1p-100f ? x : number_of(bits_of(x) + by);
}

PT_HD inline Vec3<float> leak_target(std::uint32_t kind, const Vec3<float>& a, const Vec3<float>& b,
                                     LeakRandom& random) {
    const bool is_vertex = kind == 0 || kind == 3 || kind == 6;
    const float along = kind == 1 ? 0.5f : random.unit();
    Vec3<float> target = is_vertex   ? a
                         : kind == 1 ? (a + b) * 0.5f  // an edge's midpoint is the same for both its triangles
                                     : a + (b - a) * along;
    if (kind == 3 || kind == 4) {
        target.x = nudged(target.x, random);
        target.y = nudged(target.y, random);
        target.z = nudged(target.z, random);
    }
    return target;
}

PT_HD inline Ray leak_ray(const LeakView& view, std::uint64_t number) {
    LeakRandom random(view.seed, number);
    const std::uint32_t kind = leak_class_of(number);
    const Triangle<float>& triangle = view.triangles[random.below(view.triangle_count)];
    const InnerCube& cube = view.cubes[random.below(view.cube_count)];
    const std::uint32_t first = random.below(3);
    const Vec3<float>& a = first == 0 ? triangle.a : first == 1 ? triangle.b : triangle.c;
    const Vec3<float>& b = first == 0 ? triangle.b : first == 1 ? triangle.c : triangle.a;
    Vec3<float> origin{cube.centre[0], cube.centre[1], cube.centre[2]};
    if (random.below(4) != 0) {
        origin.x += cube.half * (2.0f * random.unit() - 1.0f);
        origin.y += cube.half * (2.0f * random.unit() - 1.0f);
        origin.z += cube.half * (2.0f * random.unit() - 1.0f);
    }
    Vec3<float> direction = kind == 5 ? b - a : leak_target(kind, a, b, random) - origin;
    if (kind == 6) {  // ray class axis_plane: one component of the direction is +0 or -0
        const std::uint32_t axis = random.below(3);
        const float zero = random.below(2) == 0 ? 0.0f : -0.0f;
        const Vec3<float> flat{axis == 0 ? zero : direction.x, axis == 1 ? zero : direction.y,
                               axis == 2 ? zero : direction.z};
        // A ray direction's component is set to 0 only if enough length is left: cwbvh expects roughly unit length.
        direction = dot(flat, flat) > 0x1p-20f * dot(direction, direction) ? flat : direction;
    }
    if (random.below(2) == 0) {
        direction = direction * (1.0f / square_root(dot(direction, direction)));
    }
    return {{origin.x, origin.y, origin.z},
            std::numeric_limits<float>::infinity(),
            {direction.x, direction.y, direction.z},
            0.0f};
}

// The triangles, start cubes and seed of the leak rays, which all accelerators of a mesh share.
struct LeakSource {
    std::vector<Triangle<float>> triangles;
    std::vector<InnerCube> cubes;
    std::uint64_t seed = 1;

    LeakView view() const {
        return {triangles.data(), cubes.data(), static_cast<std::uint32_t>(triangles.size()),
                static_cast<std::uint32_t>(cubes.size()), seed};
    }
};

struct LeakCounts {
    std::uint64_t rays[leak_class_count] = {};
    std::uint64_t leaks[leak_class_count] = {};

    void add(const LeakCounts& other) {
        for (std::uint32_t kind = 0; kind < leak_class_count; ++kind) {
            rays[kind] += other.rays[kind];
            leaks[kind] += other.leaks[kind];
        }
    }
    std::uint64_t all_leaks() const {
        std::uint64_t sum = 0;
        for (const std::uint64_t count : leaks) {
            sum += count;
        }
        return sum;
    }
};

// Generates the rays first to first + count - 1 and counts, by class, those for which `misses(ray)` is true.
template <class Misses>
LeakCounts count_leaks(const LeakView& view, std::uint64_t first, std::uint64_t count, const Misses& misses) {
    LeakCounts counts;
    for (std::uint64_t number = first; number < first + count; ++number) {
        const std::uint32_t kind = leak_class_of(number);
        ++counts.rays[kind];
        counts.leaks[kind] += misses(leak_ray(view, number)) ? 1 : 0;
    }
    return counts;
}

}  // namespace pt::rays
