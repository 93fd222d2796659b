#include "harness/scene/find_room.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace pt {

namespace {

constexpr std::uint32_t nobody = 0xffffffffu;
constexpr std::size_t most_boxes = 32;         // a bit each in Room::walls
constexpr std::size_t most_candidates = 4096;  // combinations looked at: a search must not delay a large scene

// The axis boxes behind the two sides on one axis; nobody: open.
struct Sides {
    std::uint32_t low = nobody, high = nobody;
};

template <class Real>
class Search {
public:
    explicit Search(const SceneView<Real>& scene) : scene_(scene) {}

    std::optional<Room<Real>> best() const {
        std::array<std::vector<Sides>, 3> candidates;
        for (int axis = 0; axis < 3; ++axis) {
            candidates[axis] = sides_on(axis);
        }
        if (candidates[0].size() * candidates[1].size() * candidates[2].size() > most_candidates) {
            return std::nullopt;
        }
        std::optional<Room<Real>> best;
        int most_walls = 0;
        for (const Sides& x : candidates[0]) {
            for (const Sides& y : candidates[1]) {
                for (const Sides& z : candidates[2]) {
                    const std::optional<Room<Real>> room = room_between({x, y, z});
                    if (room && __builtin_popcount(room->walls) > most_walls) {
                        most_walls = __builtin_popcount(room->walls);
                        best = room;
                    }
                }
            }
        }
        return best;
    }

private:
    const AxisBox<Real>& box(std::uint32_t i) const { return scene_.axis_boxes[i]; }

    bool is_at_rest(std::uint32_t i) const {
        return scene_.velocity[scene_.first_axis_box() + i] == Vec3<Real>(Real(0));
    }

    // A wall is thinnest across itself: that keeps the search short.
    bool may_be_wall(std::uint32_t i, int axis) const {
        const Vec3<Real> size = box(i).high - box(i).low;
        return size[axis] > Real(0) && size[axis] < size[(axis + 1) % 3] && size[axis] < size[(axis + 2) % 3] &&
               is_at_rest(i);
    }

    // Pairs of walls that face each other across an axis, and single ones.
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

    std::optional<Room<Real>> room_between(const std::array<Sides, 3>& sides) const {
        std::vector<std::uint32_t> walls;
        for (const Sides& side : sides) {
            for (const std::uint32_t wall : {side.low, side.high}) {
                if (wall != nobody) {
                    walls.push_back(wall);
                }
            }
        }
        Room<Real> room;
        for (int axis = 0; axis < 3; ++axis) {
            set_sides(room, axis, sides[axis], walls);
            if (!(room.low[axis] < room.high[axis])) {
                return std::nullopt;
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (const std::uint32_t wall : {sides[axis].low, sides[axis].high}) {
                if (wall != nobody && !covers(wall, axis, room)) {
                    return std::nullopt;
                }
            }
        }
        return room;
    }

    // An open side lies as far out as any wall reaches.
    void set_sides(Room<Real>& room, int axis, const Sides& sides, const std::vector<std::uint32_t>& walls) const {
        room.low[axis] = sides.low != nobody ? box(sides.low).high[axis] : box(walls.front()).low[axis];
        room.high[axis] = sides.high != nobody ? box(sides.high).low[axis] : box(walls.front()).high[axis];
        for (const std::uint32_t wall : walls) {
            room.low[axis] = sides.low == nobody ? std::min(room.low[axis], box(wall).low[axis]) : room.low[axis];
            room.high[axis] = sides.high == nobody ? std::max(room.high[axis], box(wall).high[axis]) : room.high[axis];
        }
        const auto number = static_cast<std::uint32_t>(axis);
        const auto close = [&](std::uint32_t wall, ObjectSide& side, bool is_low) {
            if (wall == nobody) {
                room.open_sides |= 1u << (2 * number + (is_low ? 0 : 1));
            } else {
                side = ObjectSide::of_face(scene_.first_axis_box() + wall, number, is_low);
                room.walls |= 1u << wall;
            }
        };
        close(sides.low, room.low_side[axis], true);
        close(sides.high, room.high_side[axis], false);
    }

    bool covers(std::uint32_t wall, int axis, const Room<Real>& room) const {
        for (int other = 0; other < 3; ++other) {
            if (other != axis && (box(wall).low[other] > room.low[other] || box(wall).high[other] < room.high[other])) {
                return false;
            }
        }
        return true;
    }

    const SceneView<Real>& scene_;
};

template <class Real>
void describe_boxes(Room<Real>& room, const SceneView<Real>& scene) {
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    room.reach_low = Vec3<Real>(infinity);
    room.reach_high = Vec3<Real>(-infinity);
    for (std::uint32_t i = 0; i < scene.axis_boxes.size; ++i) {
        if (scene.materials[scene.object_material[scene.first_axis_box() + i]].type == MaterialType::emitter) {
            room.lamps |= 1u << i;
        }
        const bool moves = scene.velocity[scene.first_axis_box() + i] != Vec3<Real>(Real(0));
        for (int axis = 0; axis < 3; ++axis) {
            const AxisBox<Real>& box = scene.axis_boxes[i];
            room.reach_low[axis] = std::min(room.reach_low[axis], moves ? -infinity : box.low[axis]);
            room.reach_high[axis] = std::max(room.reach_high[axis], moves ? infinity : box.high[axis]);
        }
    }
}

}  // namespace

template <class Real>
Room<Real> find_room(const SceneView<Real>& scene) {
    if (scene.axis_boxes.size < 3 || scene.axis_boxes.size > most_boxes) {
        return {};
    }
    Room<Real> room = Search<Real>(scene).best().value_or(Room<Real>{});
    describe_boxes(room, scene);
    return room;
}

template Room<float> find_room(const SceneView<float>&);
template Room<double> find_room(const SceneView<double>&);

}  // namespace pt
