#include "harness/scene/find_enclosure.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "kernels/materials.h"

namespace pt {

namespace {

constexpr std::uint32_t nobody = 0xffffffffu;
constexpr std::size_t most_boxes = 32;         // limit on possible walls: AxisAlignedEnclosure::walls has 32 bits
constexpr std::size_t most_candidates = 4096;  // limit on combinations of possible enclosure walls, to bound load time

// The two axis-aligned boxes that are an enclosure's walls on one axis; `nobody` stands for an open side.
struct Sides {
    std::uint32_t low = nobody, high = nobody;
};

template <class Real>
class Search {
public:
    explicit Search(const SceneView<Real>& scene) : scene_(scene) {}

    std::optional<AxisAlignedEnclosure<Real>> best() const {
        std::array<std::vector<Sides>, 3> candidates;
        for (int axis = 0; axis < 3; ++axis) {
            candidates[axis] = sides_on(axis);
        }
        if (candidates[0].size() * candidates[1].size() * candidates[2].size() > most_candidates) {
            return std::nullopt;
        }
        std::optional<AxisAlignedEnclosure<Real>> best;
        int most_walls = 0;
        for (const Sides& x : candidates[0]) {
            for (const Sides& y : candidates[1]) {
                for (const Sides& z : candidates[2]) {
                    const std::optional<AxisAlignedEnclosure<Real>> enclosure = enclosure_between({x, y, z});
                    if (enclosure && __builtin_popcount(enclosure->walls) > most_walls) {
                        most_walls = __builtin_popcount(enclosure->walls);
                        best = enclosure;
                    }
                }
            }
        }
        return best;
    }

private:
    const AxisBox<Real>& box(std::uint32_t i) const { return scene_.axis_boxes[i]; }

    bool is_at_rest(std::uint32_t i) const {
        return scene_.velocity[first_of<ShapeKind::axis_box>(scene_) + i] == Vec3<Real>(Real(0));
    }

    // A box may be a wall on an axis only if it is thinnest along that axis, which keeps the search for walls short.
    bool may_be_wall(std::uint32_t i, int axis) const {
        const Vec3<Real> size = box(i).high - box(i).low;
        return size[axis] > Real(0) && size[axis] < size[(axis + 1) % 3] && size[axis] < size[(axis + 2) % 3] &&
               is_at_rest(i);
    }

    // Candidates for the enclosure's walls on one axis: pairs of boxes that face each other, and single boxes.
    std::vector<Sides> sides_on(int axis) const {
        std::vector<Sides> found;
        std::vector<std::uint32_t> walls;
        for (std::uint32_t i = 0; i < scene_.axis_boxes.size; ++i) {
            if (may_be_wall(i, axis)) {
                walls.push_back(i);
            }
        }
        for (const std::uint32_t low : walls) {
            for (const std::uint32_t high : walls) {
                if (box(low).high[axis] < box(high).low[axis]) {
                    found.push_back({low, high});
                }
            }
        }
        for (const std::uint32_t wall : walls) {
            found.push_back({wall, nobody});
            found.push_back({nobody, wall});
        }
        return found;
    }

    std::optional<AxisAlignedEnclosure<Real>> enclosure_between(const std::array<Sides, 3>& sides) const {
        std::vector<std::uint32_t> walls;
        for (const Sides& side : sides) {
            for (const std::uint32_t wall : {side.low, side.high}) {
                if (wall != nobody) {
                    walls.push_back(wall);
                }
            }
        }
        AxisAlignedEnclosure<Real> enclosure;
        for (int axis = 0; axis < 3; ++axis) {
            set_sides(enclosure, axis, sides[axis], walls);
            if (!(enclosure.low[axis] < enclosure.high[axis])) {
                return std::nullopt;
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (const std::uint32_t wall : {sides[axis].low, sides[axis].high}) {
                if (wall != nobody && !covers(wall, axis, enclosure)) {
                    return std::nullopt;
                }
            }
        }
        return enclosure;
    }

    // Sets the enclosure's extent along one axis. A side without a wall lies as far out as any wall reaches.
    void set_sides(AxisAlignedEnclosure<Real>& enclosure, int axis, const Sides& sides,
                   const std::vector<std::uint32_t>& walls) const {
        enclosure.low[axis] = sides.low != nobody ? box(sides.low).high[axis] : box(walls.front()).low[axis];
        enclosure.high[axis] = sides.high != nobody ? box(sides.high).low[axis] : box(walls.front()).high[axis];
        for (const std::uint32_t wall : walls) {
            enclosure.low[axis] =
                sides.low == nobody ? std::min(enclosure.low[axis], box(wall).low[axis]) : enclosure.low[axis];
            enclosure.high[axis] =
                sides.high == nobody ? std::max(enclosure.high[axis], box(wall).high[axis]) : enclosure.high[axis];
        }
        const auto number = static_cast<std::uint32_t>(axis);
        const auto close = [&](std::uint32_t wall, SurfaceId& side, bool is_low) {
            if (wall == nobody) {
                enclosure.open_sides |= 1u << (2 * number + (is_low ? 0 : 1));
            } else {
                side = SurfaceId::of_face(first_of<ShapeKind::axis_box>(scene_) + wall, number, is_low);
                enclosure.walls |= 1u << wall;
            }
        };
        close(sides.low, enclosure.low_side[axis], true);
        close(sides.high, enclosure.high_side[axis], false);
    }

    bool covers(std::uint32_t wall, int axis, const AxisAlignedEnclosure<Real>& enclosure) const {
        for (int other = 0; other < 3; ++other) {
            if (other != axis &&
                (box(wall).low[other] > enclosure.low[other] || box(wall).high[other] < enclosure.high[other])) {
                return false;
            }
        }
        return true;
    }

    const SceneView<Real>& scene_;
};

template <class Real>
void describe_boxes(AxisAlignedEnclosure<Real>& enclosure, const SceneView<Real>& scene) {
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    enclosure.reach_low = Vec3<Real>(infinity);
    enclosure.reach_high = Vec3<Real>(-infinity);
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        const std::uint32_t material = scene.object_material[first_of<ShapeKind::axis_box>(scene) + i];
        if (has_trait(scene.materials[material].type, material_trait::ends_paths)) {
            enclosure.lamps |= 1u << i;
        }
        const bool moves = scene.velocity[first_of<ShapeKind::axis_box>(scene) + i] != Vec3<Real>(Real(0));
        for (int axis = 0; axis < 3; ++axis) {
            const AxisBox<Real>& box = scene.axis_boxes[i];
            enclosure.reach_low[axis] = std::min(enclosure.reach_low[axis], moves ? -infinity : box.low[axis]);
            enclosure.reach_high[axis] = std::max(enclosure.reach_high[axis], moves ? infinity : box.high[axis]);
        }
    }
}

}  // namespace

template <class Real>
AxisAlignedEnclosure<Real> find_enclosure(const SceneView<Real>& scene) {
    if (scene.axis_boxes.size < 3 || scene.axis_boxes.size > most_boxes) {
        return {};
    }
    AxisAlignedEnclosure<Real> enclosure = Search<Real>(scene).best().value_or(AxisAlignedEnclosure<Real>{});
    describe_boxes(enclosure, scene);
    return enclosure;
}

template AxisAlignedEnclosure<float> find_enclosure(const SceneView<float>&);
template AxisAlignedEnclosure<double> find_enclosure(const SceneView<double>&);

}  // namespace pt
