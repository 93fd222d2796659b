// Ray batches on the GPU: the persistent kernels for cwbvh, plain kernels for every accelerator, and timed tree builds.
#include "harness/rays/gpu_batch.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "accelerator_list.h"  // generated: every traversal by the name of its file
#include "harness/rays/cwbvh_batch.cuh"
#include "harness/rays/cwbvh_encoder.h"
#include "harness/rays/device_memory.h"
#include "harness/rays/leak_batch.cuh"
#include "harness/rays/plain_batch.cuh"
#include "variants/builder/hploc.h"

namespace pt::rays {
namespace {

constexpr std::uint32_t block = 128;
std::uint32_t blocks_for(std::size_t count) { return static_cast<std::uint32_t>((count + block - 1) / block); }

struct PlainKernels {
    const char* accelerator;
    bool has_persistent;  // whether the accelerator has persistent kernels and a GPU encoder (cwbvh)
    void (*trace)(PlainView);
    void (*count)(PlainView, unsigned long long*);
};
template <class Traversal>
constexpr PlainKernels plain_kernels(const char* name) {
    return {name, std::is_same_v<Traversal, accelerator::cwbvh::Traversal>, trace_plain<Traversal>,
            count_work<Traversal>};
}
#define PT_PLAIN_KERNELS(name) plain_kernels<accelerator::name::Traversal>(#name),
const PlainKernels all_plain_kernels[] = {PT_ACCELERATORS(PT_PLAIN_KERNELS)};
#undef PT_PLAIN_KERNELS

struct PersistentKernel {
    const char* name;
    std::size_t threads, blocks_per_sm, shared_bytes;
    void (*closest)(BatchView);
    void (*any)(BatchView);

    // Sets the shared-memory carveout of the kernels, in percent of the 228 KiB of L1 cache and shared memory of a
    // multiprocessor, to what the resident blocks need.
    void prepare() const {
        const std::size_t bytes = (shared_bytes + sizeof(OctantOrders) + 1024) * blocks_per_sm;
        const int share = std::min<int>(static_cast<int>(bytes * 100 / (228 * 1024)) + 1, 100);
        for (const auto function : {closest, any}) {
            PT_CUDA_CHECK(cudaFuncSetAttribute(function, cudaFuncAttributePreferredSharedMemoryCarveout, share));
        }
    }
};
template <int Threads, int BlocksPerSm, int SharedEntries, int Refill, int Vote, int Groups>
PersistentKernel persistent_kernel(const char* name) {
    using Closest = BatchPolicy<Threads, BlocksPerSm, SharedEntries, Refill, Vote, Groups>;
    using Any = BatchPolicy<Threads, BlocksPerSm, SharedEntries, Refill, Vote, Groups, true>;
    return {
        name, Threads, BlocksPerSm, SharedEntries * Threads * sizeof(uint2), closest_hits<Closest>, closest_hits<Any>};
}
// The persistent kernels for cwbvh; the second one, without a vote, is faster on coherent rays.
const PersistentKernel persistent_kernels[] = {
    persistent_kernel<128, 8, 4, 8, 2, 2>("persistent"),
    persistent_kernel<128, 8, 4, 8, 0, 1>("persistent_no_vote"),
};

class GpuTracer final : public BatchTracer {
public:
    GpuTracer(const MeshView& mesh, const PlainKernels& plain)
        : plain_(plain),
          tree_(mesh.tree),
          nodes_(std::size_t{mesh.tree.node_count} * mesh.tree.node_bytes),
          leaves_(mesh.tree.slot_count),
          next_(1) {
        PT_CUDA_CHECK(cudaMemcpy(nodes_.data(), mesh.tree.nodes, nodes_.size(), cudaMemcpyHostToDevice));
        PT_CUDA_CHECK(
            cudaMemcpy(leaves_.data(), mesh.leaves, leaves_.size() * sizeof(LeafTriangle), cudaMemcpyHostToDevice));
        tree_.nodes = nodes_.data();
        if (plain.has_persistent) {
            for (const PersistentKernel& kernel : persistent_kernels) {
                kernel.prepare();
            }
        }
    }

    std::vector<std::string> kernels(const RaySet&) const override {
        std::vector<std::string> names;
        if (plain_.has_persistent) {
            for (const PersistentKernel& kernel : persistent_kernels) {
                names.emplace_back(kernel.name);
            }
        }
        names.emplace_back("plain");
        return names;
    }
    void load(const RaySet& set) override {
        any_ = set.any;
        rays_ = DeviceArray<Ray>();  // frees the old rays before the new ones are allocated
        rays_ = DeviceArray<Ray>(set.rays);
        if (hits_.size() != set.rays.size()) {
            hits_ = DeviceArray<Hit>(set.rays.size());
        }
    }
    double trace(const std::string& name) override {
        events_.start();
        if (name == "plain") {
            plain_.trace<<<blocks_for(rays_.size()), block>>>(plain_view());
        } else {
            const auto kernel = std::find_if(std::begin(persistent_kernels), std::end(persistent_kernels),
                                             [&](const PersistentKernel& candidate) { return candidate.name == name; });
            next_.clear();
            const BatchView view{tree_, leaves_.data(), rays_.data(), hits_.data(), size(), next_.data()};
            const auto function = any_ ? kernel->any : kernel->closest;
            function<<<processors_ * kernel->blocks_per_sm, kernel->threads, kernel->shared_bytes>>>(view);
        }
        PT_CUDA_CHECK(cudaGetLastError());
        return static_cast<double>(events_.stop());
    }
    std::vector<Hit> hits() override { return hits_.host(); }
    std::optional<Work> count() override {
        const DeviceArray<unsigned long long> sums(3);
        sums.clear();
        plain_.count<<<blocks_for(rays_.size()), block>>>(plain_view(), sums.data());
        PT_CUDA_CHECK(cudaGetLastError());
        const std::vector<unsigned long long> total = sums.host();
        const double rays = static_cast<double>(rays_.size());
        return Work{static_cast<double>(total[0]) / rays, static_cast<double>(total[1]) / rays,
                    static_cast<double>(total[2]) / rays};
    }
    void take_leak_source(const LeakSource& source) override {
        leak_triangles_ = DeviceArray<Triangle<float>>(source.triangles);
        leak_cubes_ = DeviceArray<InnerCube>(source.cubes);
        leak_view_ = source.view();
        leak_view_.triangles = leak_triangles_.data();
        leak_view_.cubes = leak_cubes_.data();
    }
    void make_leak_rays(std::uint64_t first, std::uint32_t count) override {
        first_leak_ray_ = first;
        any_ = false;
        if (rays_.size() != count) {
            rays_ = DeviceArray<Ray>();  // frees the old rays before the new ones are allocated
            rays_ = DeviceArray<Ray>(count);
            hits_ = DeviceArray<Hit>(count);
        }
        pt::rays::make_leak_rays<<<blocks_for(count), block>>>(leak_view_, first, rays_.data(), count);
        PT_CUDA_CHECK(cudaGetLastError());
    }
    LeakCounts leaks() override {
        const DeviceArray<unsigned long long> sums(leak_class_count);
        sums.clear();
        count_leaks<<<blocks_for(rays_.size()), block>>>(hits_.data(), first_leak_ray_, size(), sums.data());
        PT_CUDA_CHECK(cudaGetLastError());
        LeakCounts counts;
        const std::vector<unsigned long long> leaked = sums.host();
        for (std::uint32_t kind = 0; kind < leak_class_count; ++kind) {
            counts.leaks[kind] = leaked[kind];
        }
        for (std::uint64_t ray = first_leak_ray_; ray < first_leak_ray_ + leak_class_count; ++ray) {
            const std::uint64_t before = ray - first_leak_ray_;
            counts.rays[leak_class_of(ray)] = size() > before ? (size() - before - 1) / leak_class_count + 1 : 0;
        }
        return counts;
    }

private:
    std::uint32_t size() const { return static_cast<std::uint32_t>(rays_.size()); }
    PlainView plain_view() const { return {tree_, leaves_.data(), rays_.data(), hits_.data(), size(), any_}; }

    const PlainKernels& plain_;
    TreeView tree_;
    DeviceArray<unsigned char> nodes_;
    DeviceArray<LeafTriangle> leaves_;
    DeviceArray<Ray> rays_;
    DeviceArray<Hit> hits_;
    DeviceArray<std::uint32_t> next_;
    DeviceArray<Triangle<float>> leak_triangles_;
    DeviceArray<InnerCube> leak_cubes_;
    LeakView leak_view_{};
    std::uint64_t first_leak_ray_ = 0;
    bool any_ = false;
    int processors_ = processor_count();
    EventPair events_;
};

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

struct DeviceBuilder {
    std::string_view name;  // name of a choice of the axis `builder`
    void (builder::GpuTree::*build)(const Box*);
};
constexpr DeviceBuilder device_builders[] = {
    {"hploc", &builder::GpuTree::build_hploc},
    {"lbvh_gpu", &builder::GpuTree::build_lbvh},
};

bool equal(const BinaryTree& a, const BinaryTree& b) {
    return a.references == b.references && a.nodes.size() == b.nodes.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), b.nodes.size() * sizeof b.nodes[0]) == 0;
}

}  // namespace

std::vector<std::string> gpu_accelerators() {
    std::vector<std::string> names;
    for (const PlainKernels& kernels : all_plain_kernels) {
        names.emplace_back(kernels.accelerator);
    }
    return names;
}

bool has_encoder_on_gpu(const std::string& accelerator) {
    return std::any_of(std::begin(all_plain_kernels), std::end(all_plain_kernels), [&](const PlainKernels& kernels) {
        return kernels.accelerator == accelerator && kernels.has_persistent;
    });
}

std::unique_ptr<BatchTracer> make_gpu_tracer(const MeshView& mesh, const std::string& accelerator) {
    for (const PlainKernels& kernels : all_plain_kernels) {
        if (kernels.accelerator == accelerator) {
            return std::make_unique<GpuTracer>(mesh, kernels);
        }
    }
    throw cuda::Error("no batch kernel of " + accelerator);
}

std::vector<Hit> brute_force_on_gpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays) {
    std::vector<unsigned long long> start;
    for (const Ray& ray : rays) {
        start.push_back(static_cast<unsigned long long>(static_cast<std::uint32_t>(bits_of(ray.t_max))) << 32 |
                        no_primitive);
    }
    const DeviceArray<Ray> device_rays(rays);
    const DeviceArray<Triangle<float>> device_triangles(
        std::vector<Triangle<float>>(triangles.begin(), triangles.end()));
    const DeviceArray<unsigned long long> keys(start);
    brute_force<<<dim3(blocks_for(rays.size()), 256), block>>>(
        device_rays.data(), static_cast<std::uint32_t>(rays.size()), device_triangles.data(),
        static_cast<std::uint32_t>(triangles.size()), keys.data());
    PT_CUDA_CHECK(cudaGetLastError());
    std::vector<Hit> hits;
    for (const unsigned long long key : keys.host()) {
        hits.push_back({number_of(static_cast<std::int32_t>(key >> 32)), static_cast<std::uint32_t>(key)});
    }
    return hits;
}

DeviceBuild time_device_build(const std::string& name, std::span<const Triangle<float>> triangles, int repetitions) {
    DeviceBuild times;
    const auto build = std::find_if(std::begin(device_builders), std::end(device_builders),
                                    [&](const DeviceBuilder& candidate) { return candidate.name == name; });
    if (triangles.empty() || build == std::end(device_builders)) {
        return times;
    }
    const auto count = static_cast<std::uint32_t>(triangles.size());
    const DeviceArray<Triangle<float>> device_triangles(
        std::vector<Triangle<float>>(triangles.begin(), triangles.end()));
    const DeviceArray<float> boxes(6 * triangles.size());
    Box* device_boxes = reinterpret_cast<Box*>(boxes.data());
    builder::GpuTree tree(count);
    accelerator::cwbvh::GpuEncoder encoder(count);
    const EventPair events;
    BinaryTree first;
    for (int i = 0; i <= repetitions; ++i) {
        events.start();
        box_triangles<<<blocks_for(count), block>>>(device_triangles.data(), count, device_boxes);
        (tree.*build->build)(device_boxes);
        const float build_ms = events.stop();
        events.start();
        encoder.encode(tree.device_nodes(), tree.device_root());
        const float encode = events.stop();
        if (i == 0) {  // the first build of a tree is a warm-up and is not timed
            first = tree.download();
        } else {
            times.build_ms.push_back(static_cast<double>(build_ms));
            times.encode_ms.push_back(static_cast<double>(encode));
        }
    }
    times.same_every_time = equal(first, tree.download());
    return times;
}

}  // namespace pt::rays
