// The host's side of bucket.cuh.
#include <stdexcept>

#include "variants/cuda/stages.h"
#include "variants/registry.h"
#include "variants/sorting/bucket_parameters.cuh"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::bucket {
namespace {

class Bucket final : public Sorting {
public:
    bool moves_paths() const override { return false; }
    explicit Bucket(const CellContext& context) : context_(context), module_(context.module()) {}

    void reserve(Arena& arena, const Queue&) override { totals_ = arena.take<std::uint32_t>(most_bucket_keys); }

    void sort(Queue& queue, std::uint32_t key_count) override {
        if (key_count > most_bucket_keys) {
            throw std::runtime_error("sorting=bucket counts at most " + std::to_string(most_bucket_keys) +
                                     " keys, not " + std::to_string(key_count));
        }
        PT_CUDA_CHECK(cudaMemsetAsync(totals_, 0, key_count * sizeof(std::uint32_t), context_.stream));
        const std::uint32_t blocks = blocks_for(queue.bound);
        const std::uint32_t* const order = queue.indirect ? queue.order : nullptr;
        module_.launch(blocks, stage_block, context_.stream,
                       CountKeysParameters{queue.keys, queue.bound, key_count, totals_});
        module_.launch(1, stage_block, context_.stream, ScanKeysParameters{totals_, key_count});
        module_.launch(blocks, stage_block, context_.stream,
                       ScatterParameters{queue.keys, order, queue.bound, key_count, totals_, queue.order_spare});
        *context_.launches += 3;
        queue.swap_order();
        queue.indirect = true;
    }

private:
    CellContext context_;
    const Module& module_;
    std::uint32_t* totals_ = nullptr;
};

constexpr Descriptor descriptor{
    .axis = "sorting",
    .name = "bucket",
    .summary = "counting sort of slot numbers, histograms in shared memory; the payload stays in place",
    .origin = "Cycles' sorted index array",
    .traits = SortingTraits{.reproducible_order = false},
    .backends = on_cuda,
    .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
        if (variant.sort_key.is_countable()) {
            return {};
        }
        return {"needs_material_key",
                "has a bucket a material, or one in each chunk: needs sort_key=material or chunk_material, not " +
                    std::string(variant.sort_key.name)};
    },
    .check_counters = sorted_every_bounce,
};

const Registration registration(descriptor,
                                {.cuda = {.sorting = [](const CellContext& context) -> std::unique_ptr<Sorting> {
                                              return std::make_unique<Bucket>(context);
                                          },
                                          .kernels = {kernel_of<CountKeysParameters>(), kernel_of<ScanKeysParameters>(),
                                                      kernel_of<ScatterParameters>()}}});

}  // namespace
}  // namespace pt::cuda::sorting::bucket
