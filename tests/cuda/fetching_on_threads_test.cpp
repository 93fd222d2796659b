// traversal=persistent without a GPU: the kernels of integrator=wavefront with the one whose warps fetch paths, a
// thread a lane (tests/support/block_on_threads.h), leave the film of depth_first, bit for bit. What is tested is that
// every path that enters a mesh is taken through all of them once, and that the others are complete without it.
#include "tests/support/block_on_threads.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "harness/scene/scene_buffers.h"
#include "tests/support/one_by_one.h"
#include "variants/cuda/device/kernel_config.h"
#include "variants/registry.h"

inline constexpr pt::cuda::KernelConfig kernel_config{
    .features = pt::all_features | static_cast<pt::FeatureSet>(pt::Feature::mesh), .block = 64};
namespace tuned {
inline constexpr unsigned walks_apart = 0, fetch_at = 8, node_vote = 2;
}  // namespace tuned
namespace host_bytes {
inline constexpr pt::test::SameProgram generate_paths, intersect_paths, write_ray_keys, shade_paths, advance,
    intersect_meshes;
}  // namespace host_bytes
#include "tests/support/fetching_program.h"
// After it: it needs no more than its names.
#include "variants/integrator/wavefront.cuh"

namespace pt::test {
namespace {

constexpr std::uint32_t samples = 2, width = 11, height = 7, total = samples * width * height;
constexpr std::uint32_t first_sample = 2;

// All paths of the image, each in its slot, and what the host's side does with them.
class Queue {
public:
    Queue(const SceneView<float>& view, Film film)
        : view_(view),
          film_(std::move(film)),
          records_(blocks * kernel_config.block),
          hits_(total),
          keys_(total, unwritten),
          waiting_(total),
          live_(view.longest_path()),
          in_play_(view.longest_path()) {
        run(blocks, [&] { ::generate_paths(view_, store(), &count_, total, first_sample, nullptr, ::HitCache{}); });
    }

    void trace(std::uint32_t segment) {
        const std::vector<Ray<float>> rays = live_rays();
        std::fill(keys_.begin(), keys_.end(), unwritten);
        run(blocks, [&] {
            ::intersect_paths(view_, store(), nullptr, &count_, total, hits_.data(), ::HitCache{}, {segment, nullptr},
                              segments(), keys_.data(), 0, 1, last_key(), {}, list());
        });
        through_meshes_ += list_counts_.waiting;
        // By fewer lanes than there are paths, so that lanes fetch several.
        run(2, [&] { ::intersect_meshes(view_, store(), nullptr, list(), hits_.data(), keys_.data(), 0, 1, {}); });
        EXPECT_EQ(list_counts_.waiting, 0u);
        EXPECT_EQ(list_counts_.taken, 0u);
        EXPECT_EQ(list_counts_.finished, 0u);
        expect_hits(rays);
        expect_keys_of_hits();
        const FilmView sums = film_.view();
        run(blocks, [&] { ::shade_paths(view_, sums, store(), nullptr, &count_, hits_.data(), totals_.data(), {}); });
    }

    const Film& film() const { return film_; }
    std::uint64_t through_meshes() const { return through_meshes_; }
    std::uint64_t rays() const { return std::accumulate(live_.begin(), live_.end(), std::uint64_t{0}); }
    std::uint64_t paths() const {
        std::uint64_t sum = 0;
        for (const cuda::Totals& copy : totals_) {
            sum += copy.paths.paths;
        }
        return sum;
    }

private:
    static constexpr std::uint32_t blocks = (total + kernel_config.block - 1) / kernel_config.block;
    static constexpr std::uint32_t unwritten = 12345;

    template <class Kernel>
    void run(std::uint32_t count, const Kernel& kernel) {
        run_blocks(count, kernel_config.block, kernel);
    }
    cuda::PathStore store() {
        return {reinterpret_cast<unsigned char*>(records_.data()), static_cast<std::uint32_t>(records_.size())};
    }
    cuda::MeshQueue list() { return {waiting_.data(), &list_counts_}; }
    cuda::SegmentCounts segments() { return {live_.data(), in_play_.data(), 1}; }
    std::uint32_t last_key() const { return view_.materials.size + 1; }
    // By slot; of a path that has ended some ray.
    std::vector<Ray<float>> live_rays() {
        const ::Paths paths(store());
        std::vector<Ray<float>> rays;
        for (std::uint32_t i = 0; i < total; ++i) {
            rays.push_back(paths.ray(i));
            rays.back().primitive = paths.primitive(i);
        }
        return rays;
    }
    void expect_hits(const std::vector<Ray<float>>& rays) {
        const ::Paths paths(store());
        for (std::uint32_t i = 0; i < total; ++i) {
            if (paths.alive(i)) {
                const Hit<float> hit = closest_hit<::Configuration>(view_, rays[i]);
                ASSERT_EQ(hits_[i].t, hit.t) << i;
                ASSERT_EQ(hits_[i].side.exists(), hit.side.exists()) << i;
                if (hit.side.exists()) {
                    ASSERT_EQ(hits_[i].side.object(), hit.side.object()) << i;
                    ASSERT_EQ(hits_[i].side.inside(), hit.side.inside()) << i;
                }
                ASSERT_EQ(paths.primitive(i), hit.primitive) << i;
            }
        }
    }
    void expect_keys_of_hits() {
        const ::Paths paths(store());
        for (std::uint32_t i = 0; i < total; ++i) {
            const SurfaceId side = hits_[i].side;
            const std::uint32_t material = side.exists() ? view_.object_material[side.object()] : view_.materials.size;
            // Shading follows: paths that have ended before have the last key.
            EXPECT_TRUE(keys_[i] == (paths.alive(i) ? material : last_key())) << i;
        }
    }

    SceneView<float> view_;
    Film film_;
    std::vector<layout::aos::Record<float>> records_;
    std::vector<StoredHit<float>> hits_;
    std::vector<std::uint32_t> keys_;
    std::vector<std::uint32_t> waiting_;
    cuda::ListCounts list_counts_ = {};
    std::vector<std::uint64_t> live_, in_play_;
    std::vector<cuda::Totals> totals_{cuda::counter_copies};
    std::uint64_t through_meshes_ = 0;
    std::uint32_t count_ = 0;
};

// A mesh, one that overlaps it, one that rays enter which enter no other, and one that no ray meets.
::pt::Scene scene_of_meshes() {
    ::pt::Scene scene = find_scene("scenes/meshes/icosphere_room.json");
    SceneObject mesh = scene.objects.back();
    mesh.scale *= 0.5;
    mesh.translate += Vec3d(1.5, -1.0, 1.0);
    scene.objects.push_back(mesh);
    mesh.translate += Vec3d(1.8, -1.0, 1.5);
    scene.objects.push_back(mesh);
    mesh.translate = Vec3d(0, 500, 0);
    scene.objects.push_back(mesh);
    return scene;
}

TEST(FetchedPaths, LeaveTheSameFilm) {
    const ::pt::Scene scene = scene_of_meshes();
    const RenderSettings settings = few_pixels(scene, width, height);
    const SceneBuffers<float> buffers(scene, settings, by_cwbvh());
    const SceneView<float> view = buffers.view();
    const Film film(width, height, radiance_bound(scene, settings), first_sample + samples);
    const OneByOne expected = one_by_one<::Configuration>(view, film, first_sample, samples);
    Queue queue(view, film);
    for (std::uint32_t segment = 0; segment < view.longest_path(); ++segment) {
        queue.trace(segment);
    }
    EXPECT_EQ(queue.film().sums(), expected.film.sums());
    EXPECT_EQ(queue.paths(), total);
    EXPECT_EQ(queue.rays(), expected.counted.rays);
    EXPECT_GT(queue.through_meshes(), 100u);
    EXPECT_LT(queue.through_meshes(), queue.rays());
}

}  // namespace
}  // namespace pt::test
