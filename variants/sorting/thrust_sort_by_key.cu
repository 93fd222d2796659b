// The sort thrust_sort_by_key on CUDA: moves paths and their hits into the order of keys before shading, as cis565
// does.
#include <stdexcept>

#include <thrust/sort.h>

#include "variants/cuda/register.h"
#include "variants/cuda/thrust_policy.h"
#include "variants/layout/payload_iterator.cuh"
#include "variants/sorting/contiguous_payload.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::thrust_sort_by_key {
namespace {

// What the sort moves of a path and its hit, without padding (a zip of the padded record and a hit has some): moving
// bytes that nobody wrote costs time, and is what compute-sanitizer's initcheck looks for. So the path goes without its
// last two words, which only next-event estimation and meshes use: five pieces of 16 bytes in all.
struct PathWords {
    std::uint32_t word[offsetof(Path<float>, bsdf_pdf) / sizeof(std::uint32_t)];
};
struct alignas(16) PathAndHit {
    PathWords path;
    StoredHit<float> hit;
};
static_assert(sizeof(PathAndHit) == 80 && sizeof(Path<float>) == sizeof(PathWords) + 8);

template <class Paths>
struct PathAndHitSlots {
    Paths paths;
    StoredHit<float>* hits;

    PT_HD explicit PathAndHitSlots(const PathStore& store, void* hit_store = nullptr)
        : paths(store), hits(static_cast<StoredHit<float>*>(hit_store)) {}
    struct Split {
        PathWords words;
        float bsdf_pdf;
        std::uint32_t primitive;
    };
    PT_HD PathAndHit load(std::uint32_t slot) const {
        return {__builtin_bit_cast(Split, paths.load(slot)).words, hits[slot]};
    }
    PT_HD void store(std::uint32_t slot, const PathAndHit& value) const {
        paths.store(slot, __builtin_bit_cast(Path<float>, Split{value.path, 0.0f, 0u}));
        hits[slot] = value.hit;
    }
};

class SortByKey final : public Sorting {
public:
    explicit SortByKey(const CellContext& cell) : cell_(cell), thrust_(cell) {}

    // Slots from the queue's count to its bound have the largest key and lie last, where a stable sort leaves them. For
    // 32-bit keys Thrust's sort_by_key and stable_sort_by_key are one radix sort; only the latter promises stability.
    void sort(Queue& queue, std::uint32_t) override {
        if (queue.indirect) {
            throw std::logic_error("thrust_sort_by_key needs a contiguous payload");
        }
        if (queue.bound == 0) {
            return;
        }
        visit_layout(cell_.layout_name, [&](auto paths) {
            using Slots = PathAndHitSlots<typename decltype(paths)::type>;
            const SlotIterator<Slots> payload(Slots(queue.paths, queue.hits));
            thrust_.for_effect([&](const auto& policy) {
                thrust::stable_sort_by_key(policy, queue.keys, queue.keys + queue.bound, payload);
            });
        });
    }

private:
    CellContext cell_;
    ThrustCalls thrust_;
};

Reason unsupported_reason(FeatureSet features, const VariantTraits& variant) {
    if (Reason reason = needs_contiguous_payload(variant); !reason.empty()) {
        return reason;
    }
    if (variant.direct_light.connects_every_vertex) {
        return {"no_room_for_density", "moves the paths of cis565, which have no room for what direct_light=" +
                                           std::string(variant.direct_light.name) + " remembers"};
    }
    if (contains(features, Feature::mesh)) {
        return {"no_room_for_primitive",
                "moves the paths of cis565, which have no room for the triangle of a mesh that a ray starts on"};
    }
    return needs_single_precision(features, variant);
}

const Registration registration(
    {
        .axis = "sorting",
        .name = "thrust_sort_by_key",
        .summary = "thrust::stable_sort_by_key, path and hit moved",
        .origin = "cis565",
        .traits = SortingTraits{.host_sync = true},
        .backends = on_cuda,
        .tunables = thrust_tunables,
        .unsupported_reason = unsupported_reason,
        .check_counters = sorted_every_bounce,
    },
    {.sorting = [](const CellContext& cell) -> std::unique_ptr<Sorting> { return std::make_unique<SortByKey>(cell); }});

}  // namespace
}  // namespace pt::cuda::sorting::thrust_sort_by_key
