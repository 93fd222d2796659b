// The sort cub_radix: cub::DeviceRadixSort of slot numbers by the bits that the scene's keys take (one material: none).
#include "variants/cuda/radix_sort.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::cuda::sorting::cub_radix {
namespace {

const Registration registration(
    {
        .axis = "sorting",
        .name = "cub_radix",
        .summary = "cub::DeviceRadixSort::SortPairs of slot numbers, by the bits that the keys need",
        .origin = "Merrill and Grimshaw 2011; Adinets and Merrill 2022 (Onesweep)",
        .backends = on_cuda,
        .check_counters = sorted_every_bounce,
    },
    {.cuda = {.sorting = [](const CellContext& cell) -> std::unique_ptr<Sorting> {
         return std::make_unique<RadixSort>(cell, KeyBits::needed);
     }}});

}  // namespace
}  // namespace pt::cuda::sorting::cub_radix
