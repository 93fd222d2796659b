#include "harness/scene/scene_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/generate.h"
#include "harness/mesh/read_mesh.h"
#include "harness/mesh/vertex_normals.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

using Corner = std::array<float, 3>;

std::size_t least_corner(const Mesh& mesh, const std::array<std::uint32_t, 3>& indices) {
    const Corner corners[3] = {mesh.vertices[indices[0]], mesh.vertices[indices[1]], mesh.vertices[indices[2]]};
    return static_cast<std::size_t>(std::min_element(corners, corners + 3) - corners);
}

// A triangle of a mesh with its corners rotated so that the least position comes first; the winding stays.
Triangle<float> from_least_corner(const Mesh& mesh, const std::array<std::uint32_t, 3>& indices) {
    const std::size_t first = least_corner(mesh, indices);
    const auto corner = [&](std::size_t i) {
        const Corner& c = mesh.vertices[indices[(first + i) % 3]];
        return Vec3<float>(c[0], c[1], c[2]);
    };
    return {corner(0), corner(1), corner(2)};
}

CornerCoordinates coordinates_from_least_corner(const Mesh& mesh, std::size_t triangle) {
    const std::size_t first = least_corner(mesh, mesh.triangles[triangle]);
    CornerCoordinates corners{};
    for (std::size_t i = 0; i < 3; ++i) {
        // Adding +0 turns -0 into +0, so that equal texture coordinates compare equal.
        corners.u[i] = mesh.coordinates[triangle][(first + i) % 3][0] + 0.0f;
        corners.v[i] = mesh.coordinates[triangle][(first + i) % 3][1] + 0.0f;
    }
    return corners;
}

auto sort_key_of(const Triangle<float>& t) {
    return std::make_tuple(t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z);
}

auto sort_key_of(const CornerCoordinates& c) { return std::make_tuple(c.u[0], c.v[0], c.u[1], c.v[1], c.u[2], c.v[2]); }

auto sort_key_of(const CornerNormals& c) {
    return std::to_array(
        {c.of[0][0], c.of[0][1], c.of[0][2], c.of[1][0], c.of[1][1], c.of[1][2], c.of[2][0], c.of[2][1], c.of[2][2]});
}

template <class T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
    std::vector<T> ordered;
    for (std::size_t i = 0; i < values.size(); ++i) {
        ordered.push_back(values[order[i]]);
    }
    return ordered;
}

template <class T>
std::string hash_of(const std::vector<T>& values) {
    return values.empty() ? "" : fmt::format("{:016x}", fnv1a_of_bytes(values.data(), values.size() * sizeof(T)));
}

// Sorts triangles by position first, so that texture coordinates and normals do not change a mesh's order; triangles of
// equal position are sorted by texture coordinates, then by normals.
void sort_with_corners(SceneMesh& mesh) {
    std::vector<std::uint32_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto differ = [](const auto& values, std::uint32_t a, std::uint32_t b) {
        return !values.empty() && sort_key_of(values[a]) != sort_key_of(values[b]);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (differ(mesh.triangles, a, b)) {
            return sort_key_of(mesh.triangles[a]) < sort_key_of(mesh.triangles[b]);
        }
        if (differ(mesh.coordinates, a, b)) {
            return sort_key_of(mesh.coordinates[a]) < sort_key_of(mesh.coordinates[b]);
        }
        return differ(mesh.normals, a, b) && sort_key_of(mesh.normals[a]) < sort_key_of(mesh.normals[b]);
    });
    mesh.triangles = in_order(mesh.triangles, order);
    mesh.coordinates = in_order(mesh.coordinates, order);
    mesh.normals = in_order(mesh.normals, order);
    mesh.coordinates_hash = hash_of(mesh.coordinates);
    mesh.normals_hash = hash_of(mesh.normals);
}

Vec3d unit(const Vec3d& v) { return v * (1 / std::sqrt(dot(v, v))); }

// Corner normals of a triangle, beginning at its least corner, flipped to the side from which the corners go round
// anticlockwise, since a mesh may have all its triangles flipped. All 0 if the normals equal the triangle's own but for
// rounding in the file.
CornerNormals normals_from_least_corner(const Mesh& mesh, std::size_t triangle) {
    const std::array<std::uint32_t, 3>& indices = mesh.triangles[triangle];
    const std::size_t first = least_corner(mesh, indices);
    const auto vector = [](const Corner& c) { return Vec3d(c[0], c[1], c[2]); };
    const Vec3d a = vector(mesh.vertices[indices[0]]);
    const Vec3d own = unit(cross(vector(mesh.vertices[indices[1]]) - a, vector(mesh.vertices[indices[2]]) - a));
    Vec3d corners[3];
    for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = unit(vector(mesh.normals[indices[(first + i) % 3]]));
    }
    const double side = dot(corners[0] + corners[1] + corners[2], own) < 0 ? -1 : 1;
    CornerNormals normals{};
    bool is_own = true;
    for (int i = 0; i < 3; ++i) {
        const Vec3d off = corners[i] * side - own;
        constexpr double rounding = 0x1p-20;
        is_own = is_own && dot(off, off) <= rounding * rounding;
        for (int axis = 0; axis < 3; ++axis) {
            // Adding +0 turns -0 into +0, so that equal vertex normals compare equal.
            normals.of[i][axis] = static_cast<float>(corners[i][axis] * side) + 0.0f;
        }
    }
    return is_own ? CornerNormals{} : normals;
}

// Describes what is wrong with a mesh's vertex normals; empty if every corner has one.
std::string fault_of_normals(const Mesh& mesh, const std::string& source) {
    if (mesh.normals.empty()) {
        return fmt::format("the mesh {} has no normals of its vertices", source);
    }
    for (const auto& indices : mesh.triangles) {
        for (const std::uint32_t vertex : indices) {
            if (mesh.normals[vertex] == Corner{0, 0, 0}) {
                return fmt::format("in the mesh {} the normal of vertex {} (from 0) is (0, 0, 0)", source, vertex);
            }
        }
    }
    return "";
}

struct CornerHash {
    std::size_t operator()(const Corner& corner) const { return fnv1a_of_bytes(corner.data(), sizeof corner); }
};

// Numbers the distinct corner positions of all triangles, three numbers per triangle. Corners with equal coordinates
// get one number, even if they are separate vertices in the file.
std::vector<std::uint32_t> places_of_corners(const std::vector<Triangle<float>>& triangles) {
    std::unordered_map<Corner, std::uint32_t, CornerHash> known;
    known.reserve(triangles.size());
    std::vector<std::uint32_t> places;
    places.reserve(3 * triangles.size());
    for (const Triangle<float>& t : triangles) {
        for (const Vec3<float>& c : {t.a, t.b, t.c}) {
            // Adding +0 turns -0 into +0, so that equal vertex positions compare equal.
            const Corner place{c.x + 0.0f, c.y + 0.0f, c.z + 0.0f};
            places.push_back(known.try_emplace(place, static_cast<std::uint32_t>(known.size())).first->second);
        }
    }
    return places;
}

// Whether a mesh is closed: each of its edges is used equally often in both directions.
bool is_closed(const std::vector<Triangle<float>>& triangles) {
    const std::vector<std::uint32_t> places = places_of_corners(triangles);
    std::vector<std::uint64_t> there, back;
    for (std::size_t corner = 0; corner < places.size(); ++corner) {
        const std::uint32_t from = places[corner], to = places[corner % 3 == 2 ? corner - 2 : corner + 1];
        if (from != to) {
            (from < to ? there : back).push_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to));
        }
    }
    if (there.size() != back.size()) {
        return false;
    }
    std::sort(there.begin(), there.end());
    std::sort(back.begin(), back.end());
    return there == back;
}

// Most triangles of a closed mesh for which inside and outside are told apart, since the test takes every triangle.
constexpr std::size_t most_triangles_with_sides = 1u << 24;

MeshesToBe::Meshes& meshes_to_be() {
    static MeshesToBe::Meshes meshes;
    return meshes;
}

}  // namespace

MeshesToBe::MeshesToBe(Meshes meshes) { meshes_to_be() = std::move(meshes); }

MeshesToBe::~MeshesToBe() { meshes_to_be().clear(); }

std::shared_ptr<const SceneMesh> make_scene_mesh(const Mesh& mesh, const std::string& source, bool with_normals) {
    auto made = std::make_shared<SceneMesh>();
    made->source = source;
    made->degenerate_left_out = mesh.degenerate_left_out;
    made->warnings = mesh.warnings.messages();
    made->triangles.reserve(mesh.triangles.size());
    for (const auto& indices : mesh.triangles) {
        made->triangles.push_back(from_least_corner(mesh, indices));
    }
    if (with_normals) {
        made->normals_fault = fault_of_normals(mesh, source);
    }
    const bool has_normals = with_normals && made->normals_fault.empty();
    if (mesh.coordinates.empty() && !has_normals) {
        std::sort(made->triangles.begin(), made->triangles.end(),
                  [](const Triangle<float>& a, const Triangle<float>& b) { return sort_key_of(a) < sort_key_of(b); });
    } else {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            if (!mesh.coordinates.empty()) {
                made->coordinates.push_back(coordinates_from_least_corner(mesh, i));
            }
            if (has_normals) {
                made->normals.push_back(normals_from_least_corner(mesh, i));
            }
        }
        sort_with_corners(*made);
    }
    made->is_closed = made->triangles.size() <= most_triangles_with_sides && is_closed(made->triangles);
    for (const Triangle<float>& t : made->triangles) {
        const Box box = box_round(t);
        for (int axis = 0; axis < 3; ++axis) {
            made->bounds.low[axis] = std::min(made->bounds.low[axis], box.low[axis]);
            made->bounds.high[axis] = std::max(made->bounds.high[axis], box.high[axis]);
        }
    }
    made->hash = fmt::format("{:016x}",
                             fnv1a_of_bytes(made->triangles.data(), made->triangles.size() * sizeof(Triangle<float>)));
    return made;
}

std::shared_ptr<const SceneMesh> mesh_from_file(const std::filesystem::path& file, bool with_normals) {
    using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;
    static std::map<std::pair<std::string, bool>, std::pair<Stamp, std::shared_ptr<const SceneMesh>>> known;
    if (const auto to_be = meshes_to_be().find(file.string()); to_be != meshes_to_be().end()) {
        return to_be->second;
    }
    std::error_code error;
    const Stamp stamp{std::filesystem::last_write_time(file, error), std::filesystem::file_size(file, error)};
    auto& [known_stamp, mesh] = known[{file.string(), with_normals}];
    if (mesh == nullptr || error || known_stamp != stamp) {
        mesh = make_scene_mesh(read_mesh(file), file.filename().string(), with_normals);
        known_stamp = stamp;
    }
    return mesh;
}

std::shared_ptr<const SceneMesh> mesh_from_generator(const std::string& name, std::uint32_t size, bool with_normals) {
    static std::map<std::tuple<std::string, std::uint32_t, bool>, std::shared_ptr<const SceneMesh>> known;
    auto& mesh = known[{name, size, with_normals}];
    if (mesh == nullptr) {
        Mesh generated = generate_mesh(name, size);
        if (with_normals && find_generator(name)->is_smooth) {
            give_vertex_normals(generated);
        }
        mesh = make_scene_mesh(generated, fmt::format("{} {}", name, size), with_normals);
    }
    return mesh;
}

std::vector<Triangle<float>> placed_triangles(const SceneMesh& mesh, const Placement& placement) {
    const Vec3d columns[3] = {placement.column[0] * placement.scale.x, placement.column[1] * placement.scale.y,
                              placement.column[2] * placement.scale.z};
    const auto placed = [&](const Vec3<float>& p) {
        return Vec3<float>(placement.centre + columns[0] * double(p.x) + columns[1] * double(p.y) +
                           columns[2] * double(p.z));
    };
    std::vector<Triangle<float>> triangles(mesh.triangles.size());
    std::transform(mesh.triangles.begin(), mesh.triangles.end(), triangles.begin(), [&](const Triangle<float>& t) {
        return Triangle<float>{placed(t.a), placed(t.b), placed(t.c)};
    });
    return triangles;
}

Box box_round(const Triangle<float>& t) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min({t.a[axis], t.b[axis], t.c[axis]});
        box.high[axis] = std::max({t.a[axis], t.b[axis], t.c[axis]});
    }
    return box;
}

Box box_round(const SceneMesh& mesh, const Placement& placement) {
    const Box& own = mesh.bounds;
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        double low = placement.centre[axis], high = low;
        for (int i = 0; i < 3; ++i) {
            const double entry = placement.column[i][axis] * placement.scale[i];
            low += std::min(entry * own.low[i], entry * own.high[i]);
            high += std::max(entry * own.low[i], entry * own.high[i]);
        }
        constexpr float infinity = std::numeric_limits<float>::infinity();
        box.low[axis] = std::nextafter(static_cast<float>(low), -infinity);
        box.high[axis] = std::nextafter(static_cast<float>(high), infinity);
    }
    return box;
}

bool is_inside(const SceneMesh& mesh, const Vec3d& point) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(point[axis] >= mesh.bounds.low[axis] && point[axis] <= mesh.bounds.high[axis])) {
            return false;
        }
    }
    // Ray direction of the inside test: along no axis, so that the ray meets an edge in few meshes. The side from which
    // the closest triangle is hit decides, so a hit on an edge that counts for two triangles does no harm.
    const auto sheared = ShearedDirection<double>::of({0.5773, 0.5141, 0.6343});
    double nearest = std::numeric_limits<double>::infinity();
    bool from_behind = false;
    for (const Triangle<float>& t : mesh.triangles) {
        const auto hit = intersect(Triangle<double>{Vec3d(t.a), Vec3d(t.b), Vec3d(t.c)}, point, sheared);
        if (hit.hits && hit.t < nearest) {
            nearest = hit.t;
            from_behind = hit.from_behind;
        }
    }
    return from_behind;
}

}  // namespace pt
