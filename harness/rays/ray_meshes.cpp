#include "harness/rays/ray_meshes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/counted.h"
#include "harness/failure.h"
#include "harness/mesh/generate.h"
#include "harness/mesh/read_mesh.h"
#include "harness/nearest_name.h"
#include "harness/rays/probe_meshes.h"
#include "harness/scene/places.h"
#include "harness/scene/scene_mesh.h"
#include "harness/words.h"

namespace pt::rays {
namespace {

Vec3<float> vertex(const Mesh& mesh, std::uint32_t index) {
    const auto& v = mesh.vertices[index];
    return {v[0], v[1], v[2]};
}

void set_bounds(RayMesh& made) {
    made.low = made.high = made.triangles.empty() ? Vec3<float>(0.0f) : made.triangles[0].a;
    for (const Triangle<float>& t : made.triangles) {
        const Box box = box_round(t);
        for (int axis = 0; axis < 3; ++axis) {
            made.low[axis] = std::min(made.low[axis], box.low[axis]);
            made.high[axis] = std::max(made.high[axis], box.high[axis]);
        }
    }
}

// The OptiX probe's camera: just inside the box, at the centre of its front face, looking along -z.
RayCamera camera_at_front(const Vec3<float>& low, const Vec3<float>& high) {
    const Vec3<float> centre = (low + high) * 0.5f;
    const float reach = 0.995f * 0.5f * (high.z - low.z);
    return {{centre.x, centre.y, centre.z + reach}, {0.8f, 0.0f, 0.0f}, {0.0f, 0.8f, 0.0f}, {0.0f, 0.0f, -1.0f}};
}

RayMesh finished(RayMesh made) {
    if (made.mesh.triangles.empty()) {
        throw InputError("--mesh", made.name, "no triangle", "a mesh with at least one");
    }
    made.triangles.reserve(made.mesh.triangles.size());
    for (const auto& t : made.mesh.triangles) {
        made.triangles.push_back({vertex(made.mesh, t[0]), vertex(made.mesh, t[1]), vertex(made.mesh, t[2])});
    }
    set_bounds(made);
    made.camera = camera_at_front(made.low, made.high);
    return made;
}

std::array<float, 3> bounds_end(const Mesh& mesh, int axis) {
    float low = mesh.vertices[0][axis], high = low;
    for (const auto& v : mesh.vertices) {
        low = std::min(low, v[axis]);
        high = std::max(high, v[axis]);
    }
    return {low, high, 0.0f};
}

// Puts a mesh into a cube whose side is twice the mesh's largest extent.
void put_in_box(Mesh& mesh) {
    if (mesh.vertices.empty()) {
        return;
    }
    std::array<float, 3> centre;
    float half = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high, unused] = bounds_end(mesh, axis);
        centre[axis] = 0.5f * (low + high);
        half = std::max(half, high - low);
    }
    add_box(mesh, centre, half);
}

bool is_file(const std::string& argument) {
    return argument.ends_with(".ply") || argument.ends_with(".obj") || argument.ends_with(".glb");
}

RayMesh from_file(const std::string& argument) {
    RayMesh made{argument, "", read_mesh(argument), {}, {}, {}, {}};
    made.mesh.normals.clear();
    std::vector<std::string> said = made.mesh.warnings.messages();
    if (made.mesh.degenerate_left_out > 0) {
        said.push_back(counted(made.mesh.degenerate_left_out, "triangle") + " without area left out");
    }
    made.said = fmt::format("{}", fmt::join(said, "; "));
    return finished(std::move(made));
}

RayMesh generated(const std::string& argument, std::size_t colon, bool in_box) {
    const auto size = parse_number<std::uint32_t>(std::string_view(argument).substr(colon + 1));
    if (!size) {
        throw InputError("--mesh", "argument", "\"" + argument + "\"", "NAME:SIZE, SIZE a whole number");
    }
    RayMesh made{argument,
                 in_box ? "in a box of twice its extent" : "",
                 generate_mesh(argument.substr(0, colon), *size),
                 {},
                 {},
                 {},
                 {}};
    made.mesh.normals.clear();
    if (in_box) {
        put_in_box(made.mesh);
    }
    return finished(std::move(made));
}

}  // namespace

RayMesh mesh_for_rays(const std::string& argument) {
    for (const ProbeMesh& probe : probe_meshes()) {
        if (argument == probe.name) {
            return finished({argument, "", probe.make(), {}, {}, {}, {}});
        }
    }
    if (is_file(argument)) {
        return from_file(argument);
    }
    if (const std::size_t colon = argument.find(':'); colon != std::string::npos) {
        return generated(argument, colon, true);
    }
    std::vector<std::string> names;
    for (const ProbeMesh& probe : probe_meshes()) {
        names.emplace_back(probe.name);
    }
    throw InputError("--mesh", "name", "\"" + argument + "\"",
                     fmt::format("{}, NAME:SIZE (`ptbench generate` lists the names) or a file (.ply, .obj, .glb){}",
                                 fmt::join(names, ", "), did_you_mean(argument, names)));
}

RayMesh mesh_without_box(const std::string& argument) {
    const std::size_t colon = argument.find(':');
    if (!is_file(argument) && colon == std::string::npos) {
        throw InputError("--mesh", "name", "\"" + argument + "\"",
                         "NAME:SIZE (`ptbench generate` lists the names) or a file (.ply, .obj, .glb)");
    }
    return is_file(argument) ? from_file(argument) : generated(argument, colon, false);
}

RayMesh scene_for_rays(const std::string& name_or_file) {
    const Scene scene = find_scene(name_or_file);
    RayMesh made{scene.name, "", {}, {}, {}, {}, {}};
    std::size_t others = 0;
    for (const SceneObject& object : scene.objects) {
        if (!(object.shape == Shape::mesh)) {
            ++others;
            continue;
        }
        if (made.mesh.triangles.size() + scene.meshes[object.mesh]->triangles.size() > most_triangles) {
            throw InputError("--scene", scene.name, "more than 2^27 triangles with each instance by itself",
                             "at most 2^27");
        }
        for (const Triangle<float>& t :
             placed_triangles(*scene.meshes[object.mesh], placement_of(object, scene.camera.eye))) {
            const auto first = static_cast<std::uint32_t>(made.mesh.vertices.size());
            for (const Vec3<float>& v : {t.a, t.b, t.c}) {
                made.mesh.vertices.push_back({v.x, v.y, v.z});
            }
            made.mesh.triangles.push_back({first, first + 1, first + 2});
        }
    }
    if (made.mesh.triangles.empty()) {
        throw InputError("--scene", scene.name, "no mesh", "a scene with a mesh");
    }
    made = finished(std::move(made));
    if (others > 0) {
        made.said = fmt::format("{} objects that are no meshes left out", others);
    }
    const SceneCamera& camera = scene.camera;
    const auto unit = [](const Vec3d& v) { return v * (1.0 / std::sqrt(dot(v, v))); };
    const Vec3d forward = unit(camera.look_at - camera.eye), right = unit(cross(forward, camera.up));
    const double half = std::tan(camera.vertical_fov_degrees * (3.14159265358979323846 / 360.0));
    made.camera = {Vec3<float>(0.0f), Vec3<float>(right * (half * camera.width / camera.height)),
                   Vec3<float>(cross(right, forward) * half), Vec3<float>(forward)};
    return made;
}

}  // namespace pt::rays
