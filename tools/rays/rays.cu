// Rates of ray batches on a GPU: meshes of the OptiX probe, classes of rays, policies of the batch kernel; every hit of
// a subset compared with brute force and with the same traversal on the CPU.
// usage: rays [--log2-rays N] [--repeat N] [--mesh NAME]... [--out FILE] [--profile CLASS]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>

#include "harness/rays/cwbvh_batch.cuh"
#include "harness/rays/probe_meshes.h"
#include "harness/rays/ray_sets.cuh"
#include "tools/rays/device_memory.h"
#include "variants/acceleration/primitive_boxes.h"
#include "variants/builder/hploc.h"
#include "variants/builder/sah.h"
#include "variants/builder/sah_binned.h"
#include "variants/cuda/cwbvh_encoder.h"

namespace pt::rays {
namespace {

struct Options {
    std::uint32_t log2_rays = 23;
    int repeat = 7;
    std::vector<std::string> meshes;
    std::string out, profile;
};

struct PolicyKernel {
    std::string name;
    std::size_t threads, blocks_per_sm, shared_bytes;
    void (*closest)(BatchView);
    void (*any)(BatchView);
};

template <int Threads, int BlocksPerSm, int SharedEntries, int Refill, int Vote, int Groups>
PolicyKernel policy_kernel(const std::string& name) {
    using Closest = BatchPolicy<Threads, BlocksPerSm, SharedEntries, Refill, Vote, Groups>;
    using Any = BatchPolicy<Threads, BlocksPerSm, SharedEntries, Refill, Vote, Groups, true>;
    return {
        name, Threads, BlocksPerSm, SharedEntries * Threads * sizeof(uint2), closest_hits<Closest>, closest_hits<Any>};
}

std::vector<PolicyKernel> policies() {
    return {
        policy_kernel<128, 8, 4, 8, 2, 2>("t128 b8 s4 r8 v2 g2"),
        policy_kernel<128, 8, 4, 8, 3, 2>("t128 b8 s4 r8 v3 g2"),
        policy_kernel<128, 8, 4, 8, 0, 1>("t128 b8 s4 r8 v0 g1"),
    };
}

struct MeshCase {
    const char* name;
    std::function<ProbeMesh()> make;
};
std::vector<MeshCase> mesh_cases() {
    return {{"sphere_262k", [] { return sphere_in_box("sphere_262k", 256, 40.0); }},
            {"sphere_2M", [] { return sphere_in_box("sphere_2M", 724, 90.0); }},
            {"tori_262k", [] { return tori_in_box("tori_262k", 64); }},
            {"tori_4M", [] { return tori_in_box("tori_4M", 1000); }},
            {"sphere_8M", [] { return sphere_in_box("sphere_8M", 1448, 150.0); }}};
}

PrimitiveBoxes boxes_of(const std::vector<Triangle<float>>& triangles) {
    return primitive_boxes(std::span<const Triangle<float>>(triangles));
}

// A mesh on the device, and its tree on both sides.
struct Scene {
    const std::vector<Triangle<float>>& triangles;
    EncodedTree tree;
    DeviceArray<Triangle<float>> device_triangles;
    DeviceArray<NodePiece> nodes;
    DeviceArray<SlotTriangle> slots;

    Scene(const std::vector<Triangle<float>>& mesh, EncodedTree encoded)
        : triangles(mesh), tree(std::move(encoded)), device_triangles(mesh), nodes(tree.nodes) {
        std::vector<SlotTriangle> host(tree.references.size());
        for (std::size_t i = 0; i < host.size(); ++i) {
            host[i] = slot_triangle(mesh[tree.references[i]], tree.references[i]);
        }
        slots = DeviceArray<SlotTriangle>(host);
    }
    TreeView view() const {
        TreeView view = tree.view();
        view.nodes = nodes.data();
        return view;
    }
};

struct RaySet {
    std::string name;
    bool any;
    DeviceArray<Ray> rays;
};

constexpr std::uint32_t block = 128;

class Batch {
public:
    Batch(const Scene& scene, std::uint32_t count) : scene_(scene), hits_(count), next_(1), count_(count) {}

    BatchView view(const DeviceArray<Ray>& rays) {
        return {scene_.view(), scene_.slots.data(), rays.data(), hits_.data(), count_, next_.data()};
    }
    void launch(const PolicyKernel& kernel, bool any, const DeviceArray<Ray>& rays) {
        const auto function = any ? kernel.any : kernel.closest;
        next_.clear();
        function<<<processors_ * kernel.blocks_per_sm, kernel.threads, kernel.shared_bytes>>>(view(rays));
        check(cudaGetLastError());
    }
    static void prepare(const PolicyKernel& kernel) {
        const int share = static_cast<int>((kernel.shared_bytes + sizeof(OctantOrders) + 1024) * kernel.blocks_per_sm *
                                           100 / (228 * 1024)) +
                          1;
        for (const auto function : {kernel.closest, kernel.any}) {
            check(cudaFuncSetAttribute(function, cudaFuncAttributePreferredSharedMemoryCarveout, std::min(share, 100)));
        }
    }
    // Median seconds.
    double time(const std::function<void()>& work, int repeat) {
        std::vector<float> milliseconds;
        for (int i = 0; i < repeat + 1; ++i) {
            events_.start();
            work();
            milliseconds.push_back(events_.stop());
        }
        std::sort(milliseconds.begin() + 1, milliseconds.end());
        return milliseconds[1 + repeat / 2] * 1e-3;
    }
    void launch_plain(const DeviceArray<Ray>& rays) {
        closest_hits_plain<<<count_ / block, block>>>(view(rays));
        check(cudaGetLastError());
    }
    std::uint64_t checksum_of_hits() {
        DeviceArray<unsigned long long> sum(1);
        sum.clear();
        checksum<<<count_ / block, block>>>(hits_.data(), sum.data());
        return sum.host()[0];
    }
    std::vector<double> work_per_ray(const DeviceArray<Ray>& rays) {
        DeviceArray<unsigned long long> sums(3);
        sums.clear();
        count_work<<<count_ / block, block>>>(view(rays), sums.data());
        std::vector<double> mean;
        for (const unsigned long long sum : sums.host()) {
            mean.push_back(static_cast<double>(sum) / count_);
        }
        return mean;
    }
    const DeviceArray<Hit>& hits() const { return hits_; }

private:
    const Scene& scene_;
    DeviceArray<Hit> hits_;
    DeviceArray<std::uint32_t> next_;
    std::uint32_t count_;
    int processors_ = processor_count();
    EventPair events_;
};

std::vector<RaySet> ray_sets(const Scene& scene, Batch& batch, const PolicyKernel& kernel, std::uint32_t log2_rays) {
    const std::uint32_t count = 1u << log2_rays, blocks = count / block;
    std::vector<RaySet> sets;
    const auto add = [&](const char* name, bool any) -> Ray* {
        sets.push_back({name, any, DeviceArray<Ray>(count)});
        return sets.back().rays.data();
    };
    primary_rays<<<blocks, block>>>(add("primary", false), log2_rays);
    batch.launch(kernel, false, sets[0].rays);
    const Triangle<float>* mesh = scene.device_triangles.data();
    diffuse_rays<<<blocks, block>>>(sets[0].rays.data(), batch.hits().data(), mesh, 1, INFINITY,
                                    add("diffuse 1", false));
    diffuse_rays<<<blocks, block>>>(sets[0].rays.data(), batch.hits().data(), mesh, 9, 0.4f,
                                    add("ambient occlusion", true));
    shadow_rays<<<blocks, block>>>(sets[0].rays.data(), batch.hits().data(), mesh, add("shadow", true));
    DeviceArray<Ray> second(count);
    batch.launch(kernel, false, sets[1].rays);
    diffuse_rays<<<blocks, block>>>(sets[1].rays.data(), batch.hits().data(), mesh, 2, INFINITY, second.data());
    batch.launch(kernel, false, second);
    diffuse_rays<<<blocks, block>>>(second.data(), batch.hits().data(), mesh, 3, INFINITY, add("diffuse 3", false));
    random_rays<<<blocks, block>>>(add("random", false));
    check(cudaDeviceSynchronize());
    return sets;
}

// Rays and hits of every 2^k-th ray.
template <class T>
std::vector<T> sample(const DeviceArray<T>& all, std::uint32_t count) {
    std::vector<T> some(count);
    const std::size_t stride = all.size() / count * sizeof(T);
    check(cudaMemcpy2D(some.data(), sizeof(T), all.data() + all.size() / count / 2, stride, sizeof(T), count,
                       cudaMemcpyDeviceToHost));
    return some;
}

std::vector<Hit> by_brute_force(const Scene& scene, const std::vector<Ray>& rays) {
    std::vector<unsigned long long> start;
    for (const Ray& ray : rays) {
        start.push_back(static_cast<unsigned long long>(static_cast<std::uint32_t>(bits_of(ray.t_max))) << 32 |
                        no_primitive);
    }
    const DeviceArray<Ray> device_rays(rays);
    const DeviceArray<unsigned long long> keys(start);
    brute_force<<<dim3(rays.size() / block, 64), block>>>(device_rays.data(), scene.device_triangles.data(),
                                                          static_cast<std::uint32_t>(scene.triangles.size()),
                                                          keys.data());
    check(cudaGetLastError());
    std::vector<Hit> hits;
    for (const unsigned long long key : keys.host()) {
        hits.push_back({number_of(static_cast<std::int32_t>(key >> 32)), static_cast<std::uint32_t>(key)});
    }
    return hits;
}

Hit on_host(const Scene& scene, const Ray& ray) {
    const Vec3<float> origin{ray.origin[0], ray.origin[1], ray.origin[2]};
    const Vec3<float> direction{ray.direction[0], ray.direction[1], ray.direction[2]};
    const auto shear = ShearedDirection<float>::of(direction);
    Hit best{ray.t_max, no_primitive};
    NoTraversalCounter none;
    accelerator::cwbvh::traverse(
        scene.tree.view(), origin, direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t slot = first; slot < first + count; ++slot) {
                const std::uint32_t primitive = scene.tree.references[slot];
                keep_nearer(intersect(scene.triangles[primitive], origin, shear), primitive, best);
            }
        },
        none);
    return best;
}

struct Faults {
    std::uint32_t brute_force = 0, host = 0;
};

Faults compare(const Scene& scene, const RaySet& set, const DeviceArray<Hit>& hits, std::uint32_t count) {
    const std::vector<Ray> rays = sample(set.rays, count);
    const std::vector<Hit> found = sample(hits, count), expected = by_brute_force(scene, rays);
    Faults faults;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto differs = [&](const Hit& hit) {
            return set.any ? (hit.primitive == no_primitive) != (found[i].primitive == no_primitive)
                           : !(hit == found[i]);
        };
        const bool wrong = differs(expected[i]);
        if (wrong && faults.brute_force < 3) {
            std::printf("    ray %u: %.9g %u, brute force %.9g %u\n", i, found[i].t, found[i].primitive, expected[i].t,
                        expected[i].primitive);
        }
        faults.brute_force += wrong ? 1 : 0;
        faults.host += i % 4 == 0 && differs(on_host(scene, rays[i])) ? 1 : 0;
    }
    return faults;
}

std::string measure_set(const Scene& scene, Batch& batch, const RaySet& set, const Options& options) {
    std::ostringstream json;
    const double count = 1u << options.log2_rays;
    double best = 0;
    std::uint64_t sum = 0;
    std::ostringstream rates;
    std::printf("  %-18s", set.name.c_str());
    bool same = true;
    for (const PolicyKernel& kernel : policies()) {
        const double seconds = batch.time([&] { batch.launch(kernel, set.any, set.rays); }, options.repeat);
        const std::uint64_t here = batch.checksum_of_hits();
        same = same && (sum == 0 || here == sum);
        sum = here;
        best = std::max(best, count / seconds);
        rates << (rates.tellp() > 0 ? ", " : "") << '"' << kernel.name << "\": " << count / seconds * 1e-9;
        std::printf(" %.3f", count / seconds * 1e-9);
    }
    const Faults faults = compare(scene, set, batch.hits(), 1u << 14);
    const double plain = count / batch.time([&] { batch.launch_plain(set.rays); }, 3) * 1e-9;
    same = same && (set.any || batch.checksum_of_hits() == sum);
    const std::vector<double> work = batch.work_per_ray(set.rays);
    std::printf(" plain %.3f | %.2f nodes %.1f boxes %.2f triangles | faults %u %u %s\n", plain, work[0], work[1],
                work[2], faults.brute_force, faults.host, same ? "same" : "CHECKSUMS DIFFER");
    std::fflush(stdout);
    json << "{\"rays\": \"" << set.name << "\", \"query\": \"" << (set.any ? "any" : "closest")
         << "\", \"best_grays_per_s\": " << best * 1e-9 << ", \"plain_grays_per_s\": " << plain << ", \"rates\": {"
         << rates.str() << "}, \"nodes_per_ray\": " << work[0] << ", \"boxes_per_ray\": " << work[1]
         << ", \"triangles_per_ray\": " << work[2] << ", \"checksum\": \"" << std::hex << sum << std::dec
         << "\", \"checksums_agree\": " << (same ? "true" : "false")
         << ", \"differ_from_brute_force\": " << faults.brute_force << ", \"differ_from_host\": " << faults.host << "}";
    return json.str();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

__global__ void box_triangles(const Triangle<float>* triangles, std::uint32_t count, Box* boxes) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) {
        const Triangle<float> t = triangles[i];
        float* words = boxes[i].low;
        for (int k = 0; k < 3; ++k) {
            words[k] = fminf(fminf(t.a[k], t.b[k]), t.c[k]);
            words[3 + k] = fmaxf(fmaxf(t.a[k], t.b[k]), t.c[k]);
        }
    }
}

struct BuiltTree {
    std::string builder;
    BinaryTree tree;
    EncodedTree encoded;
    double build_seconds, encode_seconds;
    bool same_every_time;  // the tree of each build
};

EncodedTree download(const accelerator::cwbvh::GpuEncoder& encoder, std::uint32_t slots) {
    EncodedTree tree;
    tree.node_count = encoder.node_count();
    tree.nodes.resize(tree.node_count * (sizeof(accelerator::cwbvh::Node) / sizeof(NodePiece)));
    tree.references.resize(slots);
    check(cudaMemcpy(tree.nodes.data(), encoder.device_nodes(), tree.nodes.size() * sizeof(NodePiece),
                     cudaMemcpyDeviceToHost));
    check(cudaMemcpy(tree.references.data(), encoder.device_references(), slots * sizeof(std::uint32_t),
                     cudaMemcpyDeviceToHost));
    return tree;
}

double median_seconds(std::vector<float> milliseconds) {
    std::sort(milliseconds.begin(), milliseconds.end());
    return milliseconds[milliseconds.size() / 2] * 1e-3;
}

// From triangles on the device to a binary tree there, and from that to a wide one: medians of five, by events.
BuiltTree build_on_gpu(const std::vector<Triangle<float>>& triangles, bool hploc) {
    const auto count = static_cast<std::uint32_t>(triangles.size());
    const DeviceArray<Triangle<float>> device_triangles(triangles);
    const DeviceArray<float> boxes(6 * triangles.size());
    Box* device_boxes = reinterpret_cast<Box*>(boxes.data());
    builder::GpuTree tree(count);
    accelerator::cwbvh::GpuEncoder encoder(count);
    EventPair events;
    std::vector<float> build, encode;
    BinaryTree first;
    for (int i = 0; i < 6; ++i) {
        events.start();
        box_triangles<<<(count + block - 1) / block, block>>>(device_triangles.data(), count, device_boxes);
        hploc ? tree.build_hploc(device_boxes) : tree.build_lbvh(device_boxes);
        build.push_back(events.stop());
        events.start();
        encoder.encode(tree.device_nodes(), tree.device_root());
        encode.push_back(events.stop());
        if (i == 0) {  // warms up
            build.clear();
            encode.clear();
            first = tree.download();
        }
    }
    BinaryTree last = tree.download();
    const bool same = first.references == last.references && first.nodes.size() == last.nodes.size() &&
                      std::memcmp(first.nodes.data(), last.nodes.data(), last.nodes.size() * sizeof last.nodes[0]) == 0;
    return {hploc ? "hploc" : "lbvh", std::move(last),        download(encoder, count),
            median_seconds(build),    median_seconds(encode), same};
}

BuiltTree build_on_host(const std::vector<Triangle<float>>& triangles) {
    const PrimitiveBoxes boxes = boxes_of(triangles);
    auto start = std::chrono::steady_clock::now();
    BinaryTree tree = builder::sah_binned::build(boxes, 1);
    const double build = seconds_since(start);
    start = std::chrono::steady_clock::now();
    EncodedTree encoded = accelerator::cwbvh::encode(tree);
    return {"sah_binned", std::move(tree), std::move(encoded), build, seconds_since(start), true};
}

std::string measure_tree(const ProbeMesh& mesh, const BuiltTree& built, const Options& options) {
    try {
        builder::check(built.tree, boxes_of(mesh.triangles));
    } catch (const std::logic_error& fault) {
        std::printf("TREE OF %s: %s\n", built.builder.c_str(), fault.what());
    }
    const Scene scene(mesh.triangles, built.encoded);
    const double cost = builder::tree_cost(built.tree);
    std::printf("%s: %zu triangles, %s %.3f ms, encoding %.3f ms, SAH cost %.2f, depth %u, %u nodes%s\n",
                mesh.name.c_str(), mesh.triangles.size(), built.builder.c_str(), built.build_seconds * 1e3,
                built.encode_seconds * 1e3, cost, builder::tree_depth(built.tree), scene.tree.node_count,
                built.same_every_time ? "" : ", ANOTHER TREE EACH TIME");
    Batch batch(scene, 1u << options.log2_rays);
    const std::vector<RaySet> sets = ray_sets(scene, batch, policies()[0], options.log2_rays);
    std::ostringstream json;
    json << "{\"mesh\": \"" << mesh.name << "\", \"triangles\": " << mesh.triangles.size() << ", \"builder\": \""
         << built.builder << "\", \"build_s\": " << built.build_seconds << ", \"encode_s\": " << built.encode_seconds
         << ", \"sah_cost\": " << cost << ", \"wide_nodes\": " << scene.tree.node_count
         << ", \"same_tree_every_time\": " << (built.same_every_time ? "true" : "false") << ", \"ray_sets\": [\n";
    bool first = true;
    for (const RaySet& set : sets) {
        if (!options.profile.empty()) {
            if (set.name == options.profile) {
                batch.launch(policies()[0], set.any, set.rays);
                check(cudaDeviceSynchronize());
            }
        } else if (built.builder == "sah_binned" || set.name == "primary" || set.name == "diffuse 1") {
            json << (first ? "  " : ",\n  ") << measure_set(scene, batch, set, options);
            first = false;
        }
    }
    json << "]}";
    return json.str();
}

std::string measure_mesh(const MeshCase& mesh_case, const Options& options) {
    const ProbeMesh mesh = mesh_case.make();
    std::string json = measure_tree(mesh, build_on_host(mesh.triangles), options);
    if (options.profile.empty()) {
        for (const bool hploc : {true, false}) {
            json += ",\n" + measure_tree(mesh, build_on_gpu(mesh.triangles, hploc), options);
        }
    }
    return json;
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
            options.log2_rays = static_cast<std::uint32_t>(std::clamp(std::stoi(value), 14, 26));
        } else if (name == "--repeat") {
            options.repeat = std::max(1, std::stoi(value));
        } else if (name == "--mesh") {
            options.meshes.push_back(value);
        } else if (name == "--out") {
            options.out = value;
        } else if (name == "--profile") {
            options.profile = value;
        } else {
            throw std::invalid_argument(name + " is no option");
        }
    }
    return options;
}

int run(int argc, char** argv) {
    const Options options = read(argc, argv);
    for (const PolicyKernel& kernel : policies()) {
        Batch::prepare(kernel);
        std::printf("%s | ", kernel.name.c_str());
    }
    std::printf("\n");
    std::ostringstream json;
    json << "{\"device\": \"" << device_name() << "\", \"log2_rays\": " << options.log2_rays
         << ", \"repetitions\": " << options.repeat << ", \"statistic\": \"median\", \"meshes\": [\n";
    bool first = true;
    for (const MeshCase& mesh : mesh_cases()) {
        const auto& names = options.meshes;
        if (names.empty() || std::find(names.begin(), names.end(), mesh.name) != names.end()) {
            json << (first ? "" : ",\n") << measure_mesh(mesh, options);
            first = false;
        }
    }
    json << "]}\n";
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
        std::fprintf(stderr, "rays: %s\n", error.what());
        return 2;
    }
}
