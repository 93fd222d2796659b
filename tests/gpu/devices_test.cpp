// Renders on several GPUs: whatever the partition, the film is one GPU's. The pieces of a partition are tried on one
// GPU as well, one after the other. Skipped where there is no GPU; what needs two, where there is one.
#include <algorithm>
#include <thread>

#include <gtest/gtest.h>

#include "harness/cuda/backend.h"
#include "harness/cuda/cell.h"
#include "harness/render/device_shares.h"
#include "harness/scene/places.h"
#include "variants/cuda/runtime/arena.h"
#include "variants/cuda/runtime/handles.h"
#include "variants/cuda/runtime/nccl.h"
#include "variants/cuda/runtime/on_device.h"
#include "variants/devices/here.h"

namespace pt {
namespace {

constexpr std::uint32_t samples = 21;

RenderRequest request_for(const Scene& scene, const Variant& variant) {
    RenderRequest request{
        .variant = variant, .backend = Backend::cuda, .settings = default_settings(scene), .samples = samples};
    request.settings.width = 40;  // not a multiple of a warp
    request.settings.height = 25;
    request.settings.depth = 7;
    return request;
}

Variant cuda_variant(const std::vector<std::pair<std::string, std::string>>& choices) {
    Variant variant = Registry::instance().baseline(Backend::cuda);
    variant.set("arithmetic", "exact");
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

std::vector<std::string> names_of(std::string_view axis) {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices(axis, Backend::cuda)) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

// What the devices of a partition would add up, each rendered by the one GPU that there is.
std::vector<std::int64_t> sum_of_pieces(const Scene& scene, RenderRequest request, std::uint32_t devices) {
    const KernelChoice kernel = choose_kernel(scene, request.variant, Backend::cuda);
    const RenderSettings settings = settings_for(request, kernel);
    const PartitionTraits partition = traits_of(request.variant, Backend::cuda).partition;
    SampleSource source(partition, devices, {0, samples});
    std::vector<std::int64_t> sums(std::size_t{3} * settings.width * settings.height);
    request.samples = source.most_at_once();
    for (std::uint32_t device = 0; device < devices; ++device) {
        Film film(settings.width, settings.height, radiance_bound(scene, settings), samples);
        RenderResult result{.film = film, .work = {}, .stages = {}};
        cuda::RenderCell<float> cell(scene, request, settings, kernel, result.film.view(),
                                     rows_of(partition, device, devices));
        cell.run_pieces([&] { return source.next(device); });
        cell.collect(result);
        std::transform(sums.begin(), sums.end(), result.film.sums().begin(), sums.begin(), std::plus<>());
    }
    return sums;
}

class DevicesTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string missing = cuda::not_available(); !missing.empty()) {
            GTEST_SKIP() << missing;
        }
    }
};

// The sum of films is the one piece of its arena, whose size is no multiple of 256 bytes in most images.
TEST_F(DevicesTest, AnArenaHasRoomForThePieceItWasMadeFor) {
    cuda::Arena arena(3 * 5 * sizeof(std::int64_t));
    EXPECT_NE(arena.take<std::int64_t>(3 * 5), nullptr);
    EXPECT_THROW(arena.take<std::int64_t>(1), std::logic_error);
    cuda::Arena larger(300);
    EXPECT_NE(larger.take_bytes(300), nullptr);
}

TEST_F(DevicesTest, PiecesOfEveryPartitionAddUpToOneFilm) {
    const Scene scene = find_scene("cornell_open_five");
    for (const std::string& integrator : names_of("integrator")) {
        const std::vector<std::int64_t> whole =
            render(scene, request_for(scene, cuda_variant({{"integrator", integrator}}))).film.sums();
        for (const std::string& partition : names_of("partition")) {
            const Variant variant = cuda_variant({{"integrator", integrator}, {"partition", partition}});
            EXPECT_EQ(sum_of_pieces(scene, request_for(scene, variant), 3), whole) << integrator << " " << partition;
        }
    }
}

TEST_F(DevicesTest, RowsOfAMeshAndOfAFirstBounceCacheAddUp) {
    const Scene mesh = find_scene("meshes/icosphere_room");
    const Scene still = find_scene("cornell_open_unjittered");
    const std::pair<const Scene*, std::vector<std::pair<std::string, std::string>>> cases[] = {
        {&mesh, {{"integrator", "persistent"}, {"accelerator", "cwbvh"}}},
        {&still, {{"integrator", "megakernel_regen"}, {"first_bounce", "cached"}}},
        {&still, {{"integrator", "wavefront"}, {"first_bounce", "cached"}, {"launch", "graph"}}}};
    for (const auto& [scene, choices] : cases) {
        Variant variant = cuda_variant(choices);
        const std::vector<std::int64_t> whole = render(*scene, request_for(*scene, variant)).film.sums();
        variant.set("partition", "tiles");
        EXPECT_EQ(sum_of_pieces(*scene, request_for(*scene, variant), 2), whole) << variant.spelled_out();
    }
}

TEST_F(DevicesTest, TwoDevicesLeaveTheFilmOfOne) {
    if (const Reason reason = why_not_on(devices_here(), 2); !reason.empty()) {
        GTEST_SKIP() << reason.text;
    }
    for (const char* const name : {"cornell_open_five", "meshes/icosphere_room"}) {
        const Scene scene = find_scene(name);
        for (const std::string& integrator : names_of("integrator")) {
            const std::vector<std::pair<std::string, std::string>> choices{
                {"integrator", integrator}, {"accelerator", scene.meshes.empty() ? "brute_force" : "cwbvh"}};
            const RenderResult whole = render(scene, request_for(scene, cuda_variant(choices)));
            for (const std::string& partition : names_of("partition")) {
                Variant variant = cuda_variant(choices);
                variant.set("devices", "2");
                variant.set("partition", partition);
                RenderRequest request = request_for(scene, variant);
                const RenderResult split = render(scene, request);
                EXPECT_EQ(split.film.sums(), whole.film.sums()) << name << " " << integrator << " " << partition;
                EXPECT_EQ(split.work.paths, whole.work.paths);
                EXPECT_EQ(split.work.rays, whole.work.rays);
                EXPECT_EQ(check_counters(variant, split.work, samples, Backend::cuda), "");
                EXPECT_EQ(split.devices.own_ms.size(), 2u);
                EXPECT_NEAR(split.wall_ms, split.devices.slowest_ms + split.devices.reduce_ms, 1e-6);
                request.checkpoints = {1, 2, 8, samples};
                std::uint32_t seen = 0;
                request.on_checkpoint = [&](const Checkpoint&) { seen += 1; };
                EXPECT_EQ(render(scene, request).film.sums(), whole.film.sums()) << "with checkpoints";
                EXPECT_EQ(seen, 4u);
            }
        }
    }
}

// What allocates memory while others have ended must not meet their sum: Thrust does for each call.
TEST_F(DevicesTest, TwoDevicesWhoseCompactionAllocatesLeaveTheFilmOfOne) {
    if (const Reason reason = why_not_on(devices_here(), 2); !reason.empty()) {
        GTEST_SKIP() << reason.text;
    }
    const Scene scene = find_scene("cornell_open_five");
    Variant variant = cuda_variant({{"integrator", "wavefront"}, {"compaction", "thrust_remove_if"}});
    const std::vector<std::int64_t> whole = render(scene, request_for(scene, variant)).film.sums();
    variant.set("devices", "2");
    for (const std::string& partition : names_of("partition")) {
        variant.set("partition", partition);
        for (int time = 0; time < 10; ++time) {
            EXPECT_EQ(render(scene, request_for(scene, variant)).film.sums(), whole) << partition;
        }
    }
}

// Values of one device, and room for the sum, with a stream of its own.
struct Summing {
    explicit Summing(std::size_t device)
        : on(static_cast<int>(device)),
          arena(2 * bytes),
          stream(cuda::make_stream()),
          addend{device, 2, stream.get(), arena.take<std::int64_t>(count)},
          sum(arena.take<std::int64_t>(count)) {
        const std::vector<std::int64_t> ones(count, 1);
        PT_CUDA_CHECK(cudaMemcpy(const_cast<std::int64_t*>(addend.values), ones.data(), bytes, cudaMemcpyHostToDevice));
    }
    void add() { cuda::add_to_first(addend, sum, count); }

    static constexpr std::size_t count = 1 << 12, bytes = count * sizeof(std::int64_t);
    cuda::OnDevice on;
    cuda::Arena arena;
    cuda::Stream stream;
    cuda::Addend addend;
    std::int64_t* sum;
};

std::int64_t last_of_sum_of_two(Summing& first, Summing& second) {
    cuda::connect_devices({first.addend, second.addend}, first.sum, Summing::count);
    PT_CUDA_CHECK(cudaStreamSynchronize(first.stream.get()));
    std::jthread other([&] { second.add(); });
    first.add();
    other.join();
    std::int64_t last = 0;
    PT_CUDA_CHECK(cudaStreamSynchronize(first.stream.get()));
    PT_CUDA_CHECK(cudaMemcpy(&last, first.sum + Summing::count - 1, sizeof last, cudaMemcpyDeviceToHost));
    return last;
}

TEST_F(DevicesTest, ASumThatADeviceNeverJoinsEndsWhenItIsGivenUp) {
    if (const Reason reason = why_not_on(devices_here(), 2); !reason.empty()) {
        GTEST_SKIP() << reason.text;
    }
    Summing second(1), first(0);
    EXPECT_EQ(last_of_sum_of_two(first, second), 2);
    first.add();  // waits for the second device's part
    EXPECT_EQ(cudaStreamQuery(first.stream.get()), cudaErrorNotReady);
    (void)cudaGetLastError();
    cuda::disconnect_devices();
    EXPECT_EQ(cudaStreamSynchronize(first.stream.get()), cudaSuccess);
    EXPECT_EQ(last_of_sum_of_two(first, second), 2) << "after the devices were connected anew";
}

}  // namespace
}  // namespace pt
