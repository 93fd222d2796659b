// Rates of ray batches on one thread of the CPU: the accelerators by the functions that kernels call, and Embree by
// itself; every hit compared with bvh2's, and some with brute force. Built by `cmake --build build --target rays_cpu`.
// usage: rays_cpu [--log2-rays N] [--repeat N] [--mesh NAME]... [--out FILE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "harness/rays/probe_meshes.h"
#include "harness/rays/ray_batch.h"
#include "variants/acceleration/primitive_boxes.h"
#include "variants/registry.h"

#if defined(PTBENCH_HAS_EMBREE)
#include <embree3/rtcore.h>
#endif

namespace pt::rays {
namespace {

struct Options {
    std::uint32_t log2_rays = 17;
    int repeat = 9;
    std::vector<std::string> meshes;
    std::string out;
};

// pcg3d (Jarzynski, Olano 2020), as harness/rays/ray_sets.cuh has it.
struct RandomWords {
    std::uint32_t x, y, z;

    static RandomWords of(std::uint32_t ray, std::uint32_t depth, std::uint32_t seed) {
        RandomWords w{ray * 1664525u + 1013904223u, depth * 1664525u + 1013904223u, seed * 1664525u + 1013904223u};
        for (int round = 0; round < 2; ++round) {
            w.x += w.y * w.z, w.y += w.z * w.x, w.z += w.x * w.y;
            if (round == 0) {
                w.x ^= w.x >> 16, w.y ^= w.y >> 16, w.z ^= w.z >> 16;
            }
        }
        return w;
    }
    static float uniform(std::uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-24f; }
};

struct BuiltMesh {
    std::string name;
    std::vector<Triangle<float>> triangles;

    static BuiltMesh of(const ProbeMesh& probe) {
        const Mesh mesh = probe.make();
        BuiltMesh built{probe.name, {}};
        for (const auto& t : mesh.triangles) {
            const auto corner = [&](std::size_t k) {
                const auto& v = mesh.vertices[t[k]];
                return Vec3<float>{v[0], v[1], v[2]};
            };
            built.triangles.push_back({corner(0), corner(1), corner(2)});
        }
        return built;
    }
};

using Direction = Vec3<float>;

Ray make_ray(const Vec3<float>& o, const Direction& d) {
    return {{o.x, o.y, o.z}, std::numeric_limits<float>::infinity(), {d.x, d.y, d.z}};
}

std::vector<Ray> primary_rays(std::uint32_t log2_rays) {
    const std::uint32_t columns = 1u << (log2_rays / 2), rows = (1u << log2_rays) / columns;
    std::vector<Ray> rays;
    for (std::uint32_t i = 0; i < 1u << log2_rays; ++i) {
        const RandomWords w = RandomWords::of(i, 0, 1);
        const float across = static_cast<float>(i % columns) + RandomWords::uniform(w.x);
        const float down = static_cast<float>(i / columns) + RandomWords::uniform(w.y);
        const Direction d{(across / static_cast<float>(columns) * 2.0f - 1.0f) * 0.8f,
                          (down / static_cast<float>(rows) * 2.0f - 1.0f) * 0.8f, -1.0f};
        rays.push_back(make_ray({0.0f, 0.0f, 1.99f}, d / std::sqrt(dot(d, d))));
    }
    return rays;
}

// From 1e-4 off where the others hit, by the cosine (Malley's method), in the frame of Duff et al. 2017.
Ray diffuse_ray(const Ray& from, const Hit& hit, std::span<const Triangle<float>> triangles, const RandomWords& w) {
    const Vec3<float> o{from.origin[0], from.origin[1], from.origin[2]};
    const Direction d{from.direction[0], from.direction[1], from.direction[2]};
    Vec3<float> n{0.0f, 0.0f, 1.0f}, start = o;
    if (hit.primitive != no_primitive) {
        const Triangle<float>& t = triangles[hit.primitive];
        n = cross(t.b - t.a, t.c - t.a);
        n = n / std::sqrt(dot(n, n));
        n = dot(n, d) > 0.0f ? -n : n;
        start = o + d * hit.t + n * 1e-4f;
    }
    const float r2 = RandomWords::uniform(w.x), r = std::sqrt(r2), z = std::sqrt(1.0f - r2);
    const float phi = 6.2831853f * RandomWords::uniform(w.y);
    const float sign = std::copysign(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    const Vec3<float> tangent{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    const Vec3<float> bitangent{b, sign + n.y * n.y * a, -n.y};
    return make_ray(start, tangent * (r * std::cos(phi)) + bitangent * (r * std::sin(phi)) + n * z);
}

// A mesh as the harness's scenes hold it (harness/scene/mesh_geometry.h), under one accelerator.
class Planted {
public:
    Planted(const BuiltMesh& mesh, const AcceleratorHook& hook) : hook_(hook) {
        if (hook.encode != nullptr) {
            const Choice* builder = Registry::instance().find("builder", "sah_binned");
            encoded_ = hook.encode(builder->hook.builder.build(
                primitive_boxes(std::span<const Triangle<float>>(mesh.triangles)), mesh.triangles));
            for (const std::uint32_t primitive : encoded_.references) {
                add(mesh.triangles[primitive], primitive);
            }
        } else {
            for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
                add(mesh.triangles[i], i);
            }
        }
        if (hook.prepare != nullptr) {
            native_ = hook.prepare(encoded_, leaves_);
        }
        instance_.geometry.leaves = leaves_.data();
        instance_.geometry.triangles = mesh.triangles.data();
        instance_.geometry.tree = encoded_.view();
        instance_.geometry.tree.slot_count = static_cast<std::uint32_t>(leaves_.size());
        instance_.geometry.native = native_.data.get();
        instance_.geometry.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
        instance_.is_placed = 1;
    }
    Planted(const Planted&) = delete;
    Planted& operator=(const Planted&) = delete;

    void trace(std::span<const Ray> rays, std::span<Hit> hits) const {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& from = rays[i];
            pt::Ray<float> ray{};
            ray.origin = {from.origin[0], from.origin[1], from.origin[2]};
            ray.direction = {from.direction[0], from.direction[1], from.direction[2]};
            pt::Hit<float> best;
            best.t = from.t_max;
            hook_.meet_single(best, instance_, 0, ray.origin, ray);
            hits[i] = {best.t, best.side.exists() ? best.primitive : no_primitive};
        }
    }
    const void* native() const { return native_.data.get(); }

private:
    void add(const Triangle<float>& t, std::uint32_t primitive) {
        leaves_.push_back({{t.a.x, t.a.y, t.a.z}, primitive, {t.b.x, t.b.y, t.b.z}, 0, {t.c.x, t.c.y, t.c.z}, 0});
    }

    AcceleratorHook hook_;
    EncodedTree encoded_;
    std::vector<LeafTriangle> leaves_;
    NativeMesh native_;
    MeshInstance<float> instance_{};
};

struct Contender {
    std::string name;
    bool is_bitwise;
    std::function<void(std::span<const Ray>, std::span<Hit>)> trace;
};

#if defined(PTBENCH_HAS_EMBREE)
RTCScene scene_in(const Planted& planted) { return static_cast<RTCScene>(const_cast<void*>(planted.native())); }

void embree_single(RTCScene scene, std::span<const Ray> rays, std::span<Hit> hits) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& r = rays[i];
        RTCRayHit met{};
        met.ray = {r.origin[0], r.origin[1], r.origin[2], 0, r.direction[0], r.direction[1], r.direction[2], 0,
                   r.t_max,     ~0u,         0,           0};
        met.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &met);
        hits[i] = {met.ray.tfar, met.hit.geomID == RTC_INVALID_GEOMETRY_ID ? no_primitive : met.hit.primID};
    }
}

template <int width, class Packet, void (*intersect)(const int*, RTCScene, RTCIntersectContext*, Packet*)>
void embree_packets(RTCScene scene, bool coherent, std::span<const Ray> rays, std::span<Hit> hits) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    alignas(64) int valid[width];
    std::fill(std::begin(valid), std::end(valid), -1);
    for (std::size_t first = 0; first < rays.size(); first += width) {
        Packet p{};
        for (int k = 0; k < width; ++k) {
            const Ray& r = rays[first + static_cast<std::size_t>(k)];
            p.ray.org_x[k] = r.origin[0], p.ray.org_y[k] = r.origin[1], p.ray.org_z[k] = r.origin[2];
            p.ray.dir_x[k] = r.direction[0], p.ray.dir_y[k] = r.direction[1], p.ray.dir_z[k] = r.direction[2];
            p.ray.tfar[k] = r.t_max, p.ray.mask[k] = ~0u, p.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(valid, scene, &context, &p);
        for (int k = 0; k < width; ++k) {
            hits[first + static_cast<std::size_t>(k)] = {
                p.ray.tfar[k], p.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? no_primitive : p.hit.primID[k]};
        }
    }
}

void add_embree(std::vector<Contender>& contenders, const Planted& native) {
    const RTCScene scene = scene_in(native);
    contenders.push_back({"rtcIntersect1", false, [=](auto rays, auto hits) { embree_single(scene, rays, hits); }});
    contenders.push_back({"rtcIntersect8", false, [=](auto rays, auto hits) {
                              embree_packets<8, RTCRayHit8, &rtcIntersect8>(scene, false, rays, hits);
                          }});
    contenders.push_back({"rtcIntersect16", false, [=](auto rays, auto hits) {
                              embree_packets<16, RTCRayHit16, &rtcIntersect16>(scene, false, rays, hits);
                          }});
    contenders.push_back({"rtcIntersect16 coherent", false, [=](auto rays, auto hits) {
                              embree_packets<16, RTCRayHit16, &rtcIntersect16>(scene, true, rays, hits);
                          }});
}
#endif

// Of this thread alone: what other programs take is not in it.
double seconds() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Rates {
    std::vector<std::vector<double>> of;  // by contender and repetition, in M rays/s
    std::vector<std::size_t> different;   // hits whose primitive or t's bits are not the first contender's
    std::vector<std::size_t> other_primitive;
};

// All contenders in turn, again and again: what the machine does meanwhile meets them alike.
Rates measure(const std::vector<Contender>& contenders, std::span<const Ray> rays, std::vector<Hit>& first_hits,
              int repeat) {
    Rates rates{std::vector<std::vector<double>>(contenders.size()), {}, {}};
    for (int round = -1; round < repeat; ++round) {
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            std::vector<Hit> hits(rays.size());
            const double start = seconds();
            contenders[i].trace(rays, hits);
            const double rate = static_cast<double>(rays.size()) / (seconds() - start) * 1e-6;
            if (round >= 0) {
                rates.of[i].push_back(rate);
                continue;
            }
            if (i == 0) {
                first_hits = hits;
            }
            std::size_t different = 0, other = 0;
            for (std::size_t r = 0; r < hits.size(); ++r) {
                different += hits[r] == first_hits[r] ? 0 : 1;
                other += hits[r].primitive == first_hits[r].primitive ? 0 : 1;
            }
            rates.different.push_back(different);
            rates.other_primitive.push_back(other);
            if (contenders[i].is_bitwise && different != 0) {
                throw std::runtime_error(contenders[i].name + " has other hits than " + contenders[0].name + ": " +
                                         std::to_string(different));
            }
        }
    }
    return rates;
}

void check_by_brute_force(const BuiltMesh& mesh, std::span<const Ray> rays, std::span<const Hit> hits) {
    for (std::size_t r = 0; r < rays.size(); r += rays.size() / 64) {
        const auto sheared =
            ShearedDirection<float>::of({rays[r].direction[0], rays[r].direction[1], rays[r].direction[2]});
        Hit best{rays[r].t_max, no_primitive};
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            keep_nearer(
                intersect(mesh.triangles[i], {rays[r].origin[0], rays[r].origin[1], rays[r].origin[2]}, sheared), i,
                best);
        }
        if (!(best == hits[r])) {
            throw std::runtime_error("ray " + std::to_string(r) + " has another hit than by brute force");
        }
    }
}

std::string class_json(const std::string& name, const std::vector<Contender>& contenders, const Rates& rates,
                       std::size_t count) {
    std::ostringstream json;
    json << "    {\"class\": \"" << name << "\", \"rays\": " << count << ", \"by\": [";
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        const auto [low, high] = std::minmax_element(rates.of[i].begin(), rates.of[i].end());
        json << (i == 0 ? "\n" : ",\n") << "      {\"name\": \"" << contenders[i].name
             << "\", \"mrays_per_s\": " << median(rates.of[i]) << ", \"least\": " << *low << ", \"most\": " << *high
             << ", \"other_primitive\": " << rates.other_primitive[i] << ", \"other_bits\": " << rates.different[i]
             << "}";
        std::printf("  %-10s %-24s %7.3f M/s [%.3f, %.3f], other primitive %zu\n", name.c_str(),
                    contenders[i].name.c_str(), median(rates.of[i]), *low, *high, rates.other_primitive[i]);
    }
    std::fflush(stdout);
    json << "]}";
    return json.str();
}

std::string measure_mesh(const BuiltMesh& mesh, const Options& options) {
    std::printf("%s: %zu triangles\n", mesh.name.c_str(), mesh.triangles.size());
    std::vector<std::unique_ptr<Planted>> planted;
    std::vector<Contender> contenders;
    for (const char* name : {"bvh2", "bvh4", "bvh8", "cwbvh", "embree", "embree_native"}) {
        const Choice* choice = Registry::instance().find("accelerator", name);
        if (choice == nullptr) {
            continue;
        }
        const Planted* tree = planted.emplace_back(new Planted(mesh, choice->hook.accelerator)).get();
        contenders.push_back({name, choice->descriptor.claim == Claim::bitwise,
                              [tree](auto rays, auto hits) { tree->trace(rays, hits); }});
#if defined(PTBENCH_HAS_EMBREE)
        if (std::strcmp(name, "embree_native") == 0) {
            add_embree(contenders, *tree);
        }
#endif
    }
    std::vector<Ray> rays = primary_rays(options.log2_rays);
    std::string json = "  {\"mesh\": \"" + mesh.name + "\", \"triangles\": " + std::to_string(mesh.triangles.size()) +
                       ", \"classes\": [\n";
    for (std::uint32_t depth = 0; depth <= 3; ++depth) {
        std::vector<Hit> hits(rays.size());
        if (depth == 2) {
            planted[0]->trace(rays, hits);
        } else {
            const Rates rates = measure(contenders, rays, hits, options.repeat);
            check_by_brute_force(mesh, rays, hits);
            json += (depth == 0 ? "" : ",\n") + class_json(depth == 0 ? "primary" : "diffuse " + std::to_string(depth),
                                                           contenders, rates, rays.size());
        }
        for (std::uint32_t i = 0; i < rays.size(); ++i) {
            rays[i] = diffuse_ray(rays[i], hits[i], mesh.triangles, RandomWords::of(i, depth + 1, 3));
        }
    }
    return json + "]}";
}

Options read(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; i += 2) {
        const std::string name = argv[i];
        if (i + 1 == argc) {
            throw std::invalid_argument(name + " needs a value");
        }
        const std::string value = argv[i + 1];
        if (name == "--log2-rays") {
            options.log2_rays = static_cast<std::uint32_t>(std::clamp(std::stoi(value), 10, 24));
        } else if (name == "--repeat") {
            options.repeat = std::max(1, std::stoi(value));
        } else if (name == "--mesh") {
            options.meshes.push_back(value);
        } else if (name == "--out") {
            options.out = value;
        } else {
            throw std::invalid_argument(name + " is no option");
        }
    }
    return options;
}

std::string cpu_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.starts_with("model name")) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown";
}

double load() {
    double average = 0;
    std::ifstream("/proc/loadavg") >> average;
    return average;
}

int run(int argc, char** argv) {
    const Options options = read(argc, argv);
    std::ostringstream json;
    json << "{\"cpu\": \"" << cpu_name() << "\", \"threads\": 1, \"clock\": \"CPU time of the thread\", "
         << "\"statistic\": \"median\", \"repetitions\": " << options.repeat
         << ", \"order\": \"all contenders in turn, repeated\", \"compiler\": \"" << __VERSION__
         << "\", \"load_before\": " << load() << ", \"meshes\": [\n";
    bool first = true;
    for (const ProbeMesh& probe : probe_meshes()) {
        const BuiltMesh mesh = BuiltMesh::of(probe);
        if (mesh.triangles.size() > 300000) {
            continue;
        }
        if (options.meshes.empty() ||
            std::find(options.meshes.begin(), options.meshes.end(), mesh.name) != options.meshes.end()) {
            json << (first ? "" : ",\n") << measure_mesh(mesh, options);
            first = false;
        }
    }
    json << "],\n\"load_after\": " << load() << "}\n";
    if (!options.out.empty()) {
        std::ofstream(options.out + ".partial") << json.str();
        std::rename((options.out + ".partial").c_str(), options.out.c_str());
    }
    return 0;
}

}  // namespace
}  // namespace pt::rays

int main(int argc, char** argv) {
    try {
        return pt::rays::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "rays_cpu: %s\n", error.what());
        return 2;
    }
}
