// The compactions and sorts that rest on Thrust and CUB, held against the standard library on hand-made queues, in
// every layout. Skipped where there is no GPU, but for what the choices say of themselves.
#include <gtest/gtest.h>

#include "tests/gpu/device_queue.h"

namespace pt::test {
namespace {

constexpr std::uint32_t sizes[] = {0, 1, 31, 33, 1000, 100003};
constexpr double ended_fractions[] = {0, 0.5, 1};
constexpr const char* layouts[] = {"aos", "soa", "packed"};

// A choice with its tunables, in a layout.
struct Case {
    std::string choice;
    Cell::Tuning tuning;
    std::string layout;
};
std::ostream& operator<<(std::ostream& out, const Case& tested) {
    out << tested.choice << "_" << tested.layout;
    for (const auto& [tunable, value] : tested.tuning) {
        out << (value != 0 ? "_" + tunable : "");
    }
    return out;
}

std::vector<Cell::Tuning> tunings_of(const std::string& choice) {
    if (choice.rfind("thrust_", 0) == 0) {
        std::vector<Cell::Tuning> all;
        for (const std::uint32_t caching : {0u, 1u}) {
            for (const std::uint32_t nosync : {0u, 1u}) {
                all.push_back({{"caching_allocator", caching}, {"par_nosync", nosync}});
            }
        }
        return all;
    }
    if (choice.rfind("cub_select_", 0) == 0) {
        return {{{"payload", 0}}, {{"payload", 1}}};
    }
    return {{}};
}

std::vector<Case> cases_of(const std::vector<std::string>& choices) {
    std::vector<Case> all;
    for (const std::string& choice : choices) {
        for (const Cell::Tuning& tuning : tunings_of(choice)) {
            for (const char* layout : layouts) {
                all.push_back({choice, tuning, layout});
            }
        }
    }
    return all;
}

const std::vector<std::string> compactions = {"thrust_remove_if",     "thrust_partition",   "thrust_stable_partition",
                                              "thrust_copy_if_index", "cub_select_flagged", "cub_select_if",
                                              "cub_partition",        "cub_three_way"};
const std::vector<std::string> sortings = {"thrust_sort_by_key", "cub_radix", "cub_radix_full"};

bool is_thrust(const std::string& choice) { return choice.rfind("thrust_", 0) == 0; }
bool moves_payload(const Case& tested) {
    const auto payload = tested.tuning.find("payload");
    return payload != tested.tuning.end() ? payload->second != 0
                                          : is_thrust(tested.choice) && tested.choice != "thrust_copy_if_index";
}

std::vector<std::uint32_t> ids_of(const std::vector<Path<float>>& paths) {
    std::vector<std::uint32_t> ids;
    for (const Path<float>& path : paths) {
        ids.push_back(path.pixel);
    }
    return ids;
}
std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> ids) {
    std::sort(ids.begin(), ids.end());
    return ids;
}
// The path with this id, as it was put in.
bool are_as_put_in(const std::vector<Path<float>>& found, const DeviceQueue& made) {
    return std::all_of(found.begin(), found.end(), [&](const Path<float>& path) {
        return path.pixel < made.paths.size() && same_bits(path, made.paths[path.pixel]);
    });
}
bool payload_is_in_place(const DeviceQueue& made) {
    const std::vector<Path<float>> found = made.device_paths();
    return std::equal(found.begin(), found.end(), made.paths.begin(), same_bits);
}

// Ids of the live of the first `count` paths: in the order of their slots, or in the queue's.
std::vector<std::uint32_t> live_ids(const DeviceQueue& made, std::uint32_t count, bool by_slot) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t slot = by_slot ? i : made.order[i];
        if (made.paths[slot].alive()) {
            ids.push_back(slot);
        }
    }
    return ids;
}

class CudaTest : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        if (const std::string reason = no_device(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }
    static std::unique_ptr<cuda::Compaction> make_compaction(const std::string& name, const Cell& cell) {
        return cuda_hooks("compaction", name).compaction(cell.context);
    }
    static std::unique_ptr<cuda::Sorting> make_sorting(const std::string& name, const Cell& cell) {
        return cuda_hooks("sorting", name).sorting(cell.context);
    }
};

// ---- compactions

class CudaCompactionTest : public CudaTest {
protected:
    static Cell make_cell() {
        return {GetParam().layout, cuda_descriptor("compaction", GetParam().choice), GetParam().tuning};
    }
    // Holds what is in play, which was `count` paths of `made` as they were put in, against the standard library.
    static void check(DeviceQueue& made, std::uint32_t count, std::uint32_t bound_before) {
        const Case& tested = GetParam();
        const std::vector<Path<float>> in_play = made.in_play();
        std::vector<std::uint32_t> expected = live_ids(made, count, moves_payload(tested));
        if (tested.choice == "cub_three_way") {
            std::stable_partition(expected.begin(), expected.end(), [&](std::uint32_t id) {
                const SurfaceId origin_surface = made.paths[id].origin_surface;
                return !origin_surface.exists() || made.object_class[origin_surface.object()] == 0;
            });
        }
        ASSERT_EQ(made.device_count(), expected.size());
        if (tested.choice == "thrust_partition") {
            ASSERT_EQ(sorted(ids_of(in_play)), expected);
        } else {
            ASSERT_EQ(ids_of(in_play), expected);
        }
        ASSERT_TRUE(are_as_put_in(in_play, made));
        ASSERT_EQ(made.queue.bound, is_thrust(tested.choice) ? expected.size() : bound_before);
        if (moves_payload(tested)) {
            ASSERT_FALSE(made.queue.indirect);
        } else {
            ASSERT_TRUE(payload_is_in_place(made));
            ASSERT_TRUE(made.queue.indirect || bound_before == 0);
        }
        if (tested.choice.find("partition") != std::string::npos && is_thrust(tested.choice)) {  // nothing is lost
            std::vector<Path<float>> all = made.device_paths();
            all.resize(count);
            ASSERT_TRUE(are_as_put_in(all, made));
            std::vector<std::uint32_t> every(count);
            std::iota(every.begin(), every.end(), 0u);
            ASSERT_EQ(sorted(ids_of(all)), every);
        }
    }
};

TEST_P(CudaCompactionTest, AgreesWithTheStandardLibrary) {
    std::uint64_t seed = 1;
    for (const std::uint32_t size : sizes) {
        for (const double ended : ended_fractions) {
            for (const bool indirect : {false, true}) {
                // Thrust has returned the count, so its bound is the count.
                for (const std::uint32_t slack : {0u, 37u, 5000u}) {
                    if (is_thrust(GetParam().choice) && slack != 0) {
                        continue;
                    }
                    const Shape shape{size, slack, ended, indirect, ++seed};
                    SCOPED_TRACE(testing::Message() << size << " paths, bound + " << slack << ", ended " << ended
                                                    << (indirect ? ", by an order" : ""));
                    Cell cell = make_cell();
                    const auto compaction = make_compaction(GetParam().choice, cell);
                    DeviceQueue made(cell, shape, *compaction);
                    compaction->compact(made.queue);
                    ASSERT_NO_FATAL_FAILURE(check(made, size, size + slack));
                    if (size + slack != 0) {
                        ASSERT_GT(cell.launches, 0u);
                        ASSERT_EQ(cell.host_waits, is_thrust(GetParam().choice) ? 1u : 0u);
                    }
                }
            }
        }
    }
}

// Ends every third path in play and makes what is there now what was put in: slots are renamed by where they lie.
void next_bounce(DeviceQueue& made) {
    const std::uint32_t count = made.device_count();
    std::vector<Path<float>> all = made.device_paths();
    made.order.resize(made.slots());
    std::iota(made.order.begin(), made.order.end(), 0u);
    if (made.queue.indirect) {
        const std::vector<std::uint32_t> listed = made.device_order(count);
        std::copy(listed.begin(), listed.end(), made.order.begin());
    }
    for (std::uint32_t slot = 0; slot < made.slots(); ++slot) {
        all[slot].pixel = slot;
    }
    for (std::uint32_t i = 0; i < count; i += 3) {
        all[made.order[i]].segment = Path<float>::ended;
    }
    made.paths = all;
    made.put_paths(all);
}

// One object and one queue from bounce to bounce, as in a render, until no path is left and beyond.
TEST_P(CudaCompactionTest, CompactsBounceAfterBounce) {
    Cell cell = make_cell();
    const auto compaction = make_compaction(GetParam().choice, cell);
    DeviceQueue made(cell, {20000, 0, 0.3, false, 99}, *compaction);
    std::uint32_t count = 20000;
    for (int bounce = 0; bounce < 30; ++bounce) {
        SCOPED_TRACE(bounce);
        const std::uint32_t bound = made.queue.bound;
        compaction->compact(made.queue);
        ASSERT_NO_FATAL_FAILURE(check(made, count, bound));
        next_bounce(made);
        count = made.device_count();
    }
    EXPECT_LE(count, 1u);
}

// A sort of slot numbers between two compactions; a payload mover drops its order.
TEST_P(CudaCompactionTest, CompactsAfterAnIndexSort) {
    Cell cell = make_cell();
    const auto compaction = make_compaction(GetParam().choice, cell);
    const auto sorting = make_sorting("cub_radix", cell);
    DeviceQueue made(cell, {20000, 0, 0.3, false, 98}, *compaction, *sorting);
    std::uint32_t count = 20000;
    for (int bounce = 0; bounce < 5; ++bounce) {
        SCOPED_TRACE(bounce);
        std::vector<std::uint32_t> keys(made.queue.bound, 4);
        for (std::uint32_t i = 0; i < count; ++i) {
            keys[i] = made.paths[made.order[i]].medium % 5;
        }
        upload(made.queue.keys, keys);
        sorting->sort(made.queue, 5);
        std::stable_sort(made.order.begin(), made.order.begin() + count, [&](std::uint32_t a, std::uint32_t b) {
            return made.paths[a].medium % 5 < made.paths[b].medium % 5;
        });
        const std::uint32_t bound = made.queue.bound;
        compaction->compact(made.queue);
        ASSERT_NO_FATAL_FAILURE(check(made, count, bound));
        next_bounce(made);
        count = made.device_count();
    }
}

// What says that it does not wait for the device can be recorded in a graph; what is recorded is the whole of it.
TEST_P(CudaCompactionTest, IsCapturedUnlessItWaits) {
    const Descriptor& descriptor = cuda_descriptor("compaction", GetParam().choice);
    const bool waits = traits_in<CompactionTraits>(descriptor).host_sync;
    ASSERT_EQ(waits, is_thrust(GetParam().choice));
    if (waits) {
        return;
    }
    Cell cell = make_cell();
    const auto compaction = make_compaction(GetParam().choice, cell);
    const Shape shape{10000, 10, 0.5, true, 97};
    DeviceQueue made(cell, shape, *compaction);
    {  // kernels are loaded at their first launch, which must not be recorded
        const auto warm = make_compaction(GetParam().choice, cell);
        DeviceQueue other(cell, shape, *warm);
        warm->compact(other.queue);
        other.wait();
    }
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t executable = nullptr;
    PT_CUDA_CHECK(cudaStreamBeginCapture(cell.stream, cudaStreamCaptureModeThreadLocal));
    compaction->compact(made.queue);
    PT_CUDA_CHECK(cudaStreamEndCapture(cell.stream, &graph));
    PT_CUDA_CHECK(cudaGraphInstantiate(&executable, graph, 0));
    PT_CUDA_CHECK(cudaGraphLaunch(executable, cell.stream));
    made.wait();
    check(made, shape.count, shape.count + shape.slack);
    PT_CUDA_CHECK(cudaGraphExecDestroy(executable));
    PT_CUDA_CHECK(cudaGraphDestroy(graph));
}

INSTANTIATE_TEST_SUITE_P(Choices, CudaCompactionTest, testing::ValuesIn(cases_of(compactions)),
                         testing::PrintToStringParamName());

// ---- sorts

// The key of a path is a function of the path, so it can be asked for again after the payload has moved.
std::uint32_t key_of(const Path<float>& path, std::uint32_t key_count) { return path.medium % key_count; }

class CudaSortingTest : public CudaTest {};

TEST_P(CudaSortingTest, IsStableAndHitsGoWithTheirPaths) {
    const Case& tested = GetParam();
    std::uint64_t seed = 1000;
    for (const std::uint32_t size : sizes) {
        for (const std::uint32_t key_count : {1u, 2u, 6u, 64u, 1000u, 1u << 20, 0xffffffffu}) {
            for (const std::uint32_t slack : {0u, 37u}) {
                for (const bool indirect : {false, true}) {
                    if (indirect && moves_payload(tested)) {
                        continue;  // does not apply
                    }
                    SCOPED_TRACE(testing::Message() << size << " paths, bound + " << slack << ", " << key_count
                                                    << " keys" << (indirect ? ", by an order" : ""));
                    Cell cell(tested.layout, cuda_descriptor("sorting", tested.choice), tested.tuning);
                    const auto sorting = make_sorting(tested.choice, cell);
                    // thrust_sort_by_key moves the record of cis565, which has no room for a density.
                    const bool with_density = std::string(tested.choice) != "thrust_sort_by_key";
                    DeviceQueue made(cell, {size, slack, 0.2, indirect, ++seed, with_density}, *sorting);
                    std::vector<std::uint32_t> keys(made.slots(), key_count - 1);
                    for (std::uint32_t i = 0; i < size; ++i) {
                        keys[i] = key_of(made.paths[made.order[i]], key_count);
                    }
                    upload(made.queue.keys, keys);
                    std::vector<std::uint32_t> expected(made.order.begin(), made.order.begin() + size);
                    std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
                        return key_of(made.paths[a], key_count) < key_of(made.paths[b], key_count);
                    });

                    sorting->sort(made.queue, key_count);

                    ASSERT_EQ(made.device_count(), size);
                    ASSERT_EQ(made.queue.bound, size + slack);
                    ASSERT_EQ(made.queue.indirect, !moves_payload(tested) && (indirect || made.slots() != 0));
                    const std::vector<Path<float>> in_play = made.in_play();
                    ASSERT_EQ(ids_of(in_play), expected);
                    ASSERT_TRUE(are_as_put_in(in_play, made));
                    const std::vector<Path<float>> all = made.device_paths();
                    const std::vector<StoredHit<float>> hits = made.device_hits();
                    for (std::uint32_t slot = 0; slot < made.slots(); ++slot) {
                        ASSERT_EQ(hits[slot].side.code, all[slot].pixel);
                        ASSERT_EQ(hits[slot].t, static_cast<float>(all[slot].pixel));
                    }
                    if (!moves_payload(tested)) {
                        ASSERT_TRUE(payload_is_in_place(made));
                        // Positions beyond the count are permuted among themselves: no slot is lost or doubled.
                        ASSERT_EQ(sorted(made.device_order(made.slots())), sorted(made.order));
                    }
                }
            }
        }
    }
}

TEST_P(CudaSortingTest, SaysWhetherItWaits) {
    const bool says_so = traits_in<SortingTraits>(cuda_descriptor("sorting", GetParam().choice)).host_sync;
    ASSERT_EQ(says_so, is_thrust(GetParam().choice));
    Cell cell(GetParam().layout, cuda_descriptor("sorting", GetParam().choice), GetParam().tuning);
    const auto sorting = make_sorting(GetParam().choice, cell);
    DeviceQueue made(cell, {1000, 0, 0, false, 5}, *sorting);
    upload(made.queue.keys, std::vector<std::uint32_t>(1000, 1));
    sorting->sort(made.queue, 2);
    const auto is_set = [](const char* tunable) {
        const auto tuned = GetParam().tuning.find(tunable);
        return tuned != GetParam().tuning.end() && tuned->second != 0;
    };
    const bool waits = is_thrust(GetParam().choice) && !(is_set("par_nosync") && is_set("caching_allocator"));
    EXPECT_EQ(cell.host_waits, waits ? 1u : 0u);
    made.wait();
}

INSTANTIATE_TEST_SUITE_P(Choices, CudaSortingTest, testing::ValuesIn(cases_of(sortings)),
                         testing::PrintToStringParamName());

// ---- what the choices say of themselves: no GPU is needed

TEST(CudaDescriptorTest, PayloadMoversNeedSinglePrecision) {
    VariantTraits variant;
    variant.precision = {traits_in<PrecisionTraits>(cuda_descriptor("precision", "double")), "double"};
    const auto reason = [&](const char* axis, const std::string& name) -> std::string {
        const Descriptor& descriptor = cuda_descriptor(axis, name);
        return descriptor.unsupported_reason == nullptr ? "" : descriptor.unsupported_reason(no_features, variant).text;
    };
    for (const std::string name : {"thrust_remove_if", "thrust_partition", "thrust_stable_partition"}) {
        EXPECT_NE(reason("compaction", name).find("needs precision=float"), std::string::npos) << name;
    }
    for (const std::string name : {"thrust_copy_if_index", "cub_partition", "cub_three_way"}) {
        EXPECT_EQ(reason("compaction", name), "") << name;
    }
    for (const std::string name : {"cub_select_flagged", "cub_select_if"}) {
        EXPECT_EQ(reason("compaction", name), "") << name;
        variant.tuning["payload"] = 1;
        EXPECT_NE(reason("compaction", name).find("needs precision=float"), std::string::npos) << name;
        variant.tuning.clear();
    }
    EXPECT_NE(reason("sorting", "thrust_sort_by_key").find("needs precision=float"), std::string::npos);
    variant.precision = {};
    EXPECT_EQ(reason("sorting", "thrust_sort_by_key"), "");
    variant.compaction = {traits_in<CompactionTraits>(cuda_descriptor("compaction", "cub_partition")), "cub_partition"};
    EXPECT_NE(reason("sorting", "thrust_sort_by_key").find("compaction=cub_partition"), std::string::npos);
}

TEST(CudaDescriptorTest, OnlyPayloadMoversKeepThePayloadContiguous) {
    for (const std::string& name : compactions) {
        const bool contiguous = is_thrust(name) && name != "thrust_copy_if_index";
        EXPECT_EQ(traits_in<CompactionTraits>(cuda_descriptor("compaction", name)).payload_contiguous, contiguous)
            << name;
        EXPECT_EQ(cuda_descriptor("compaction", name).backends, on_cuda) << name;
    }
}

}  // namespace
}  // namespace pt::test
