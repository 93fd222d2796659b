#include "harness/rays/leak_study.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/exact_math.h"
#include "harness/mesh/generate.h"
#include "harness/scene/scene_mesh.h"

namespace pt::rays {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t inner_cubes = 256;
constexpr std::size_t shown_leaks = 8;  // number of leaked rays that are listed per kernel

// The squared distance of a point to a triangle (Ericson, "Real-Time Collision Detection", 2005, 5.1.5).
double squared_distance(const Vec3d& p, const Triangle<float>& triangle) {
    const Vec3d a(triangle.a), ab = Vec3d(triangle.b) - a, ac = Vec3d(triangle.c) - a, ap = p - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    const Vec3d bp = ap - ab, cp = ap - ac;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    Vec3d nearest(0.0);
    if (d1 <= 0 && d2 <= 0) {
        nearest = Vec3d(0.0);
    } else if (d3 >= 0 && d4 <= d3) {
        nearest = ab;
    } else if (d6 >= 0 && d5 <= d6) {
        nearest = ac;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        nearest = ab * (d1 / (d1 - d3));
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        nearest = ac * (d2 / (d2 - d6));
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        nearest = ab + (ac - ab) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    } else {
        nearest = ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc));
    }
    const Vec3d off = ap - nearest;
    return dot(off, off);
}

double distance_from(const std::vector<Triangle<float>>& triangles, const Vec3d& p) {
    double least = std::numeric_limits<double>::infinity();
#pragma omp parallel for reduction(min : least)
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        least = std::min(least, squared_distance(p, triangles[i]));
    }
    return std::sqrt(least);
}

std::string hex(const float (&v)[3]) { return fmt::format("{:a} {:a} {:a}", v[0], v[1], v[2]); }

Json leak_json(const LeakSource& source, std::uint64_t number) {
    const Ray ray = leak_ray(source.view(), number);
    return {{"ray", number},
            {"class", leak_classes[leak_class_of(number)]},
            {"origin", hex(ray.origin)},
            {"direction", hex(ray.direction)}};
}

// How many rays leaked through one tree when one kernel traced them, and the first of these rays.
struct KernelLeaks {
    std::string kernel;
    LeakCounts counts;
    double ms = 0;
    std::vector<std::uint64_t> first;

    Json json(const LeakSource& source) const {
        Json classes = Json::array(), shown = Json::array();
        std::uint64_t rays = 0;
        for (std::uint32_t kind = 0; kind < leak_class_count; ++kind) {
            classes.push_back(
                {{"class", leak_classes[kind]}, {"rays", counts.rays[kind]}, {"leaks", counts.leaks[kind]}});
            rays += counts.rays[kind];
        }
        for (const std::uint64_t number : first) {
            shown.push_back(leak_json(source, number));
        }
        return {{"kernel", kernel},
                {"rays", rays},
                {"leaks", counts.all_leaks()},
                {"ms", ms},
                {"classes", std::move(classes)},
                {"first_leaks", std::move(shown)}};
    }
};

// Counts the leaks of every kernel of a tree. All kernels trace the same rays, batch by batch.
std::vector<KernelLeaks> leaks_through(BatchTracer& tracer, const LeakSource& source, const LeakStudy& study) {
    std::vector<KernelLeaks> kernels;
    for (const std::string& kernel : tracer.kernels(RaySet{"leaks", false, {}})) {
        kernels.push_back({kernel, {}, 0, {}});
    }
    const std::uint64_t all = std::uint64_t{1} << study.log2_rays;
    const std::uint64_t batch =
        std::min<std::uint64_t>(all, study.trees.backend == Backend::cuda ? 1u << 25 : 1u << 16);
    tracer.take_leak_source(source);
    for (std::uint64_t done = 0; done < all; done += batch) {
        const std::uint64_t first = study.first_ray + done;
        tracer.make_leak_rays(first, static_cast<std::uint32_t>(batch));
        for (KernelLeaks& kernel : kernels) {
            kernel.ms += tracer.trace(kernel.kernel);
            const LeakCounts counts = tracer.leaks();
            kernel.counts.add(counts);
            if (counts.all_leaks() > 0 && kernel.first.size() < shown_leaks) {
                const std::vector<Hit> hits = tracer.hits();
                for (std::size_t i = 0; i < hits.size() && kernel.first.size() < shown_leaks; ++i) {
                    if (hits[i].primitive == no_primitive) {
                        kernel.first.push_back(first + i);
                    }
                }
            }
        }
    }
    return kernels;
}

}  // namespace

RayMesh closed_mesh_for_rays(const std::string& argument) {
    RayMesh mesh = mesh_without_box(argument);
    if (!make_scene_mesh(mesh.mesh, mesh.name)->is_closed) {
        std::string closed;
        for (const Generator& generator : generators()) {
            closed += generator.closed ? fmt::format("{}{}", closed.empty() ? "" : ", ", generator.name) : "";
        }
        throw InputError("--mesh", mesh.name, "a mesh that is not closed",
                         fmt::format("a closed one, of which rays cannot leave ({}:SIZE, or a file)", closed));
    }
    return mesh;
}

LeakSource leak_source(const RayMesh& mesh, std::uint32_t count, std::uint64_t seed) {
    LeakSource source{mesh.triangles, {}, seed};
    const auto closed = make_scene_mesh(mesh.mesh, mesh.name);
    const Vec3d low(mesh.low), extent = Vec3d(mesh.high) - low;
    const double size = std::sqrt(dot(extent, extent));
    MeshRandom random(seed);
    for (std::uint32_t tries = 0; source.cubes.size() < count && tries < 64 * count; ++tries) {
        const glm::dvec3 at = random.point(0.0, 1.0);
        const Vec3<float> centre(low + extent * Vec3d(at.x, at.y, at.z));
        if (!is_inside(*closed, Vec3d(centre))) {
            continue;
        }
        // A start cube is half as large as would fit, so that its corners stay inside the mesh after rounding.
        const double half = distance_from(source.triangles, Vec3d(centre)) / (2 * std::sqrt(3.0));
        if (half > 0x1p-16 * size) {
            source.cubes.push_back({{centre.x, centre.y, centre.z}, static_cast<float>(half)});
        }
    }
    if (source.cubes.empty()) {
        throw InputError("--mesh", mesh.name, "no place well inside of the mesh", "a mesh with an inside");
    }
    return source;
}

LeakResult measure_leaks(const RayMesh& mesh, const LeakStudy& study) {
    const LeakSource source = leak_source(mesh, inner_cubes, study.seed);
    const std::string hash = content_hash(mesh.mesh);
    const auto scene_mesh = as_scene_mesh(mesh, hash);
    LeakResult result;
    Json trees = Json::array();
    for (const auto& [accelerator, builder] : trees_of(study.trees)) {
        const Tree tree = make_tree(scene_mesh, accelerator, builder, study.trees.backend);
        const auto tracer = make_tracer(tree, study.trees.backend);
        Json kernels = Json::array();
        for (const KernelLeaks& kernel : leaks_through(*tracer, source, study)) {
            kernels.push_back(kernel.json(source));
            result.leaks += kernel.counts.all_leaks();
        }
        trees.push_back({{"accelerator", accelerator},
                         {"builder", builder.empty() ? Json() : Json(builder)},
                         {"kernels", std::move(kernels)}});
    }
    result.json = {{"mesh", mesh.name},
                   {"triangles", mesh.triangles.size()},
                   {"hash", hash},
                   {"inner_cubes", source.cubes.size()},
                   {"seed", study.seed},
                   {"first_ray", study.first_ray},
                   {"trees", std::move(trees)}};
    return result;
}

std::string leak_table_of(const Json& mesh) {
    std::string text =
        fmt::format("{:<14} {:<12} {:<19} {:>12} {:>8}\n", "accelerator", "builder", "kernel", "rays", "leaks");
    for (const Json& tree : mesh["trees"]) {
        for (const Json& kernel : tree["kernels"]) {
            text += fmt::format("{:<14} {:<12} {:<19} {:>12} {:>8}\n", tree["accelerator"].get<std::string>(),
                                tree["builder"].is_null() ? "-" : tree["builder"].get<std::string>(),
                                kernel["kernel"].get<std::string>(), kernel["rays"].get<std::uint64_t>(),
                                kernel["leaks"].get<std::uint64_t>());
            for (const Json& leak : kernel["first_leaks"]) {
                text += fmt::format("  LEAK ray {} ({}): {} -> {}\n", leak["ray"].get<std::uint64_t>(),
                                    leak["class"].get<std::string>(), leak["origin"].get<std::string>(),
                                    leak["direction"].get<std::string>());
            }
        }
    }
    return text;
}

}  // namespace pt::rays
