// Measures rates of ray batches on one CPU thread: accelerators by the functions that kernels call, and Embree alone.
// Hits are compared with bvh2's, and some with brute force. Built by `cmake --build build --target rays_cpu`.
// usage: rays_cpu [--log2-rays N] [--repeat N] [--mesh NAME]... [--out FILE]
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "harness/machine/machine.h"
#include "harness/rays/cpu_batch.h"
#include "harness/rays/probe_meshes.h"
#include "harness/rays/ray_sets.h"
#include "variants/bvh/primitive_boxes.h"
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

// A mesh in the form of the harness's scenes (harness/scene/mesh_geometry.h), with a tree of one accelerator.
class Planted {
public:
    Planted(const RayMesh& mesh, const AcceleratorHook& hook) : hook_(hook) {
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
            hook_.meet_single(best, instance_, 0, ray.origin, ray, 0);
            hits[i] = {best.t, best.side.exists() ? best.primitive : no_primitive};
        }
    }
    const MeshView& view() const { return instance_.geometry; }

private:
    void add(const Triangle<float>& t, std::uint32_t primitive) { leaves_.push_back(LeafTriangle::of(t, primitive)); }

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
RTCScene scene_in(const Planted& planted) { return static_cast<RTCScene>(const_cast<void*>(planted.view().native)); }

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

// CPU time of this thread in seconds, which excludes time taken by other programs.
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
    std::vector<std::vector<double>> of;  // rates in M rays/s, by contender and repetition
    std::vector<std::size_t> different;   // hits whose primitive or bits of t differ from the first contender's
    std::vector<std::size_t> other_primitive;
};

// Times the contenders in turn, repeatedly, so that changes of the machine's load affect all of them alike.
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

void check_by_brute_force(const RayMesh& mesh, std::span<const Ray> rays, std::span<const Hit> hits) {
    std::vector<Ray> some_rays;
    std::vector<Hit> their_hits;
    for (std::size_t r = 0; r < rays.size(); r += rays.size() / 64) {
        some_rays.push_back(rays[r]);
        their_hits.push_back(hits[r]);
    }
    if (brute_force_on_cpu(mesh.triangles, some_rays) != their_hits) {
        throw std::runtime_error(mesh.name + ": a ray has another hit than by brute force");
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

std::string measure_mesh(const RayMesh& mesh, const Options& options) {
    std::printf("%s: %zu triangles\n", mesh.name.c_str(), mesh.triangles.size());
    std::vector<std::unique_ptr<Planted>> planted;
    std::vector<Contender> contenders;
    for (const Choice* choice : Registry::instance().choices(axes::accelerator, Backend::cpu)) {
        const std::string name(choice->descriptor.name);
        if (name == "brute_force") {
            continue;
        }
        const Planted* tree = planted.emplace_back(new Planted(mesh, choice->hook.accelerator)).get();
        contenders.push_back({name, choice->descriptor.claim == Claim::bitwise,
                              [tree](auto rays, auto hits) { tree->trace(rays, hits); }});
#if defined(PTBENCH_HAS_EMBREE)
        if (name == "embree_native") {
            add_embree(contenders, *tree);
        }
#endif
    }
    const AcceleratorHook& bvh2 = Registry::instance().find("accelerator", "bvh2")->hook.accelerator;
    const std::unique_ptr<BatchTracer> tracer = make_cpu_tracer(planted[0]->view(), "bvh2", bvh2.meet_single);
    std::string json = "  {\"mesh\": \"" + mesh.name + "\", \"triangles\": " + std::to_string(mesh.triangles.size()) +
                       ", \"classes\": [\n";
    const std::vector<std::string> classes{"primary", "diffuse_1", "diffuse_3"};
    for (const RaySet& set : make_ray_sets(mesh, *tracer, classes, options.log2_rays)) {
        std::vector<Hit> hits;
        const Rates rates = measure(contenders, set.rays, hits, options.repeat);
        check_by_brute_force(mesh, set.rays, hits);
        std::string name = set.name;  // class of rays as spelt in the committed result file
        std::replace(name.begin(), name.end(), '_', ' ');
        json += (set.name == classes.front() ? "" : ",\n") + class_json(name, contenders, rates, set.rays.size());
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
    json << "{\"schema\": \"ptbench-rays-cpu-1\", \"commit\": \"" << git_sha() << "\", \"cpu\": \"" << cpu_name()
         << "\", \"threads\": 1, \"clock\": \"CPU time of the thread\", "
         << "\"statistic\": \"median\", \"repetitions\": " << options.repeat
         << ", \"order\": \"all contenders in turn, repeated\", \"compiler\": \"" << __VERSION__
         << "\", \"load_before\": " << load() << ", \"meshes\": [\n";
    bool first = true;
    for (const ProbeMesh& probe : probe_meshes()) {
        const RayMesh mesh = mesh_for_rays(probe.name);
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
