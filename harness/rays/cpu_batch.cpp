#include "harness/rays/cpu_batch.h"

#include <chrono>
#include <cmath>

#include "accelerator_list.h"  // generated: every traversal by the name of its file
#include "harness/rays/leak_rays.h"
#include "kernels/intersect.h"

namespace pt::rays {
namespace {

template <class Traversal, class Counter>
Hit trace_generic(const MeshView& mesh, const Ray& ray, bool any, Counter& counter) {
    const Vec3<float> origin = vector_of<float>(ray.origin), direction = vector_of<float>(ray.direction);
    const auto sheared = ShearedDirection<float>::of(direction);
    Hit best{ray.t_max, no_primitive};
    Traversal::traverse(
        mesh.tree, origin, direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t slot = first; slot < first + count; ++slot) {
                const LeafTriangle& leaf = mesh.leaves[slot];
                keep_nearer(intersect(leaf.triangle<float>(), origin, sheared), leaf.primitive(), best);
                if (any && best.primitive != no_primitive) {
                    best = {-1.0f, 0};
                    return;
                }
            }
        },
        counter);
    return any && best.primitive != no_primitive ? Hit{0.0f, 0} : best;
}

struct Generic {
    const char* accelerator;
    Hit (*trace)(const MeshView&, const Ray&, bool, NoTraversalCounter&);
    Hit (*count)(const MeshView&, const Ray&, bool, TraversalCounter&);
};
template <class Traversal>
constexpr Generic generic(const char* accelerator) {
    return {accelerator, trace_generic<Traversal, NoTraversalCounter>, trace_generic<Traversal, TraversalCounter>};
}
#define PT_GENERIC(name) generic<accelerator::name::Traversal>(#name),
constexpr Generic all_generic[] = {PT_ACCELERATORS(PT_GENERIC)};
#undef PT_GENERIC

class CpuTracer final : public BatchTracer {
public:
    CpuTracer(const MeshView& mesh, const std::string& accelerator, MeetMesh<float> meet_function)
        : meet_(meet_function) {
        mesh_.geometry = mesh;
        mesh_.is_placed = 1;
        for (const Generic& candidate : all_generic) {
            if (candidate.accelerator == accelerator) {
                generic_ = &candidate;
            }
        }
    }

    std::vector<std::string> kernels(const RaySet& set) const override {
        return {set.any && generic_ != nullptr ? "any" : "meet"};
    }
    void load(const RaySet& set) override {
        set_ = &set;
        hits_.resize(set.rays.size());
    }
    double trace(const std::string& kernel) override {
        const auto start = std::chrono::steady_clock::now();
        const auto count = static_cast<std::int64_t>(hits_.size());
        const bool by_meeting = kernel == "meet";
#pragma omp parallel for schedule(dynamic, 1024)
        for (std::int64_t i = 0; i < count; ++i) {
            NoTraversalCounter none;
            hits_[i] = by_meeting ? meet(set_->rays[i]) : generic_->trace(mesh_.geometry, set_->rays[i], true, none);
        }
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    std::vector<Hit> hits() override { return hits_; }
    std::optional<Work> count() override {
        if (generic_ == nullptr) {
            return std::nullopt;
        }
        std::uint64_t nodes = 0, boxes = 0, triangles = 0;
        const auto count = static_cast<std::int64_t>(hits_.size());
#pragma omp parallel for schedule(dynamic, 1024) reduction(+ : nodes, boxes, triangles)
        for (std::int64_t i = 0; i < count; ++i) {
            TraversalCounter counter;
            (void)generic_->count(mesh_.geometry, set_->rays[i], set_->any, counter);
            nodes += counter.nodes_visited;
            boxes += counter.boxes_tested;
            triangles += counter.primitives_tested;
        }
        const auto rays = static_cast<double>(count);
        return Work{static_cast<double>(nodes) / rays, static_cast<double>(boxes) / rays,
                    static_cast<double>(triangles) / rays};
    }

    void take_leak_source(const LeakSource& source) override { leak_view_ = source.view(); }
    void make_leak_rays(std::uint64_t first, std::uint32_t count) override {
        first_leak_ray_ = first;
        leak_rays_.rays.resize(count);
#pragma omp parallel for
        for (std::uint32_t i = 0; i < count; ++i) {
            leak_rays_.rays[i] = leak_ray(leak_view_, first + i);
        }
        load(leak_rays_);
    }
    LeakCounts leaks() override {
        LeakCounts counts;
        for (std::size_t i = 0; i < hits_.size(); ++i) {
            const std::uint32_t kind = leak_class_of(first_leak_ray_ + i);
            ++counts.rays[kind];
            counts.leaks[kind] += hits_[i].primitive == no_primitive ? 1 : 0;
        }
        return counts;
    }

private:
    Hit meet(const Ray& ray) const {
        // A ray of a batch may hit at t == t_max, an accelerator takes only t < best.t: best.t starts just above t_max.
        pt::Hit<float> best;
        best.t = std::nextafter(ray.t_max, std::numeric_limits<float>::infinity());
        const Vec3<float> origin = vector_of<float>(ray.origin);
        const pt::Ray<float> as_rendered{origin, vector_of<float>(ray.direction), 0.0f, SurfaceId(), 0};
        meet_(best, mesh_, 0, origin, as_rendered, 0);
        if (!best.side.exists()) {
            return {ray.t_max, no_primitive};
        }
        return set_->any ? Hit{0.0f, 0} : Hit{best.t, best.primitive};
    }

    MeshInstance<float> mesh_{};
    MeetMesh<float> meet_;
    const Generic* generic_ = nullptr;
    const RaySet* set_ = nullptr;
    std::vector<Hit> hits_;
    LeakView leak_view_{};
    RaySet leak_rays_{"leaks", false, {}};
    std::uint64_t first_leak_ray_ = 0;
};

}  // namespace

std::unique_ptr<BatchTracer> make_cpu_tracer(const MeshView& mesh, const std::string& accelerator,
                                             MeetMesh<float> meet) {
    return std::make_unique<CpuTracer>(mesh, accelerator, meet);
}

std::vector<Hit> brute_force_on_cpu(std::span<const Triangle<float>> triangles, const std::vector<Ray>& rays) {
    std::vector<Hit> hits(rays.size());
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Vec3<float> origin = vector_of<float>(rays[i].origin);
        const auto sheared = ShearedDirection<float>::of(vector_of<float>(rays[i].direction));
        hits[i] = {rays[i].t_max, no_primitive};
        for (std::uint32_t k = 0; k < triangles.size(); ++k) {
            keep_nearer(intersect(triangles[k], origin, sheared), k, hits[i]);
        }
    }
    return hits;
}

}  // namespace pt::rays
