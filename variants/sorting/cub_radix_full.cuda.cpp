// The sort cub_radix_full sorts by all 32 bits of a key, CUB's default. Against cub_radix it shows what the bits cost.
#include "variants/cuda/radix_sort.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::cub_radix_full {
namespace {

const Registration registration(
    {
        .axis = "sorting",
        .name = "cub_radix_full",
        .summary = "cub::DeviceRadixSort::SortPairs of slot numbers, by all 32 bits of the keys",
        .origin = "Merrill and Grimshaw 2011; Adinets and Merrill 2022 (Onesweep)",
        .backends = on_cuda,
        .check_counters = sorted_every_bounce,
    },
    {.cuda = {.sorting = [](const CellContext& cell) -> std::unique_ptr<Sorting> {
         return std::make_unique<RadixSort>(cell, KeyBits::all);
     }}});

}  // namespace
}  // namespace pt::cuda::sorting::cub_radix_full
