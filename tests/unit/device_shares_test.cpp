// What devices take of a render: every pixel and sample exactly once, whatever the partition and the number of devices.
#include "harness/render/device_shares.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "harness/scene/places.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

const std::map<std::string, PartitionTraits> partitions{
    {"samples", {}}, {"tiles", {.is_by_rows = true}}, {"dynamic", {.is_dynamic = true}}};

// Counts by row and sample how often some device takes it; `whose_turn` picks the device that asks next.
template <class Turn>
std::vector<std::vector<int>> takings(const PartitionTraits& partition, std::uint32_t devices, std::uint32_t first,
                                      std::uint32_t samples, std::uint32_t height, const Turn& whose_turn) {
    std::vector<std::vector<int>> taken(height, std::vector<int>(samples));
    const std::uint32_t used = devices_at_work(partition, devices, samples, height);
    SampleSource source(partition, used, {first, samples});
    std::vector<std::uint32_t> busy(used);
    for (std::uint32_t device = 0; device < used; ++device) {
        busy[device] = device;
    }
    while (!busy.empty()) {
        const std::size_t turn = whose_turn(busy.size());
        const std::uint32_t device = busy[turn];
        const std::optional<SampleRange> range = source.next(device);
        if (!range) {
            busy.erase(busy.begin() + static_cast<std::ptrdiff_t>(turn));
            continue;
        }
        EXPECT_LE(range->count, source.most_at_once());
        const Rows rows = rows_of(partition, device, used);
        std::uint32_t own_rows = 0;
        for (std::uint32_t row = rows.first; row < height; row += rows.step, ++own_rows) {
            for (std::uint32_t sample = range->first; sample < range->first + range->count; ++sample) {
                taken.at(row).at(sample - first) += 1;
            }
        }
        EXPECT_EQ(own_rows, rows.count(height));
    }
    return taken;
}

TEST(DeviceSharesTest, TakeEveryPixelAndSampleOnce) {
    std::mt19937 random(4);
    for (const auto& [name, partition] : partitions) {
        for (const std::uint32_t devices : {1u, 2u, 3u, 4u, 5u, 8u, 13u}) {
            for (const std::uint32_t samples : {1u, 2u, 3u, 7u, 16u, 100u, 1023u}) {
                for (const std::uint32_t height : {1u, 2u, 5u, 24u}) {
                    const auto taken = takings(partition, devices, 5, samples, height,
                                               [&](std::size_t count) { return random() % count; });
                    for (const std::vector<int>& row : taken) {
                        ASSERT_TRUE(std::all_of(row.begin(), row.end(), [](int times) { return times == 1; }))
                            << name << ", " << devices << " devices, " << samples << " samples, " << height << " rows";
                    }
                }
            }
        }
    }
}

TEST(DeviceSharesTest, GiveNoDeviceMoreThanItsPart) {
    EXPECT_EQ(devices_at_work(partitions.at("samples"), 4, 3, 100), 3u);
    EXPECT_EQ(devices_at_work(partitions.at("tiles"), 4, 1, 100), 4u);
    EXPECT_EQ(devices_at_work(partitions.at("tiles"), 4, 100, 2), 2u);
    SampleSource source(partitions.at("samples"), 3, {10, 8});
    EXPECT_EQ(source.next(2), (SampleRange{16, 2}));
    EXPECT_EQ(source.next(0), (SampleRange{10, 3}));
    EXPECT_EQ(source.next(1), (SampleRange{13, 3}));
    EXPECT_EQ(source.next(1), std::nullopt);
}

// A device that is three times as fast takes about three times as much, and none waits long at the end.
TEST(DeviceSharesTest, DynamicFollowsTheSpeedOfDevices) {
    constexpr std::uint32_t samples = 4096;
    const double seconds_a_sample[] = {1, 3};
    SampleSource source(partitions.at("dynamic"), 2, {0, samples});
    double busy_until[] = {0, 0};
    std::uint32_t taken[] = {0, 0};
    bool is_done[] = {false, false};
    while (!is_done[0] || !is_done[1]) {
        const int device = is_done[1] || (!is_done[0] && busy_until[0] <= busy_until[1]) ? 0 : 1;
        const std::optional<SampleRange> range = source.next(static_cast<std::uint32_t>(device));
        is_done[device] = !range;
        if (range) {
            taken[device] += range->count;
            busy_until[device] += range->count * seconds_a_sample[device];
        }
    }
    EXPECT_EQ(taken[0] + taken[1], samples);
    const double ideal = samples / (1 / seconds_a_sample[0] + 1 / seconds_a_sample[1]);
    EXPECT_LE(std::max(busy_until[0], busy_until[1]), 1.02 * ideal);
}

// Devices that ask at the same time, in threads, get each sample once.
TEST(DeviceSharesTest, DynamicHandsOutEachSampleOnceToThreads) {
    constexpr std::uint32_t samples = 20000, devices = 4;
    SampleSource source(partitions.at("dynamic"), devices, {0, samples});
    std::vector<std::vector<int>> taken(devices, std::vector<int>(samples));
    std::vector<std::thread> threads;
    for (std::uint32_t device = 0; device < devices; ++device) {
        threads.emplace_back([&, device] {
            while (const auto range = source.next(device)) {
                for (std::uint32_t i = 0; i < range->count; ++i) {
                    taken[device][range->first + i] += 1;
                }
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
        int times = 0;
        for (const std::vector<int>& device : taken) {
            times += device[sample];
        }
        ASSERT_EQ(times, 1) << sample;
    }
}

// The films of simulated devices, each a render of the CPU backend, add up to the film of one.
TEST(DeviceSharesTest, FilmsOfSharesAddUpToOneFilm) {
    const Scene scene = find_scene("cornell_open");
    RenderRequest whole{.variant = Registry::instance().baseline(), .settings = default_settings(scene), .samples = 21};
    whole.settings.width = 24;
    whole.settings.height = 20;
    const std::string expected = render(scene, whole).film.hash();
    for (const char* const name : {"samples", "dynamic"}) {
        for (const std::uint32_t devices : {1u, 2u, 4u, 7u}) {
            SampleSource source(partitions.at(name), devices, {0, whole.samples});
            Film film = render(scene, whole).film;
            std::vector<std::int64_t> sums(film.sums().size());
            for (std::uint32_t turn = 0, idle = 0; idle < devices; ++turn) {
                const std::optional<SampleRange> range = source.next(turn % devices);
                idle = range ? 0 : idle + 1;
                if (!range) {
                    continue;
                }
                RenderRequest share = whole;
                share.first_sample = range->first;
                share.samples = range->count;
                share.film_samples = whole.samples;
                const RenderResult result = render(scene, share);
                std::transform(sums.begin(), sums.end(), result.film.sums().begin(), sums.begin(), std::plus<>());
            }
            film.set(sums, {});
            EXPECT_EQ(film.hash(), expected) << name << " on " << devices;
        }
    }
}

}  // namespace
}  // namespace pt
