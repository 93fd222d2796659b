// How the samples or image rows of a render are divided among several devices; needs no device.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "variants/axes.h"

namespace pt {

// Every step-th row of an image: first, first + step, first + 2 step, ...
struct Rows {
    std::uint32_t first = 0, step = 1;

    std::uint32_t count(std::uint32_t height) const { return first < height ? (height - first - 1) / step + 1 : 0; }
    bool operator==(const Rows&) const = default;
};

// A range of samples of every pixel: `count` samples from `first` on.
struct SampleRange {
    std::uint32_t first = 0, count = 0;
    bool operator==(const SampleRange&) const = default;
};

// Part number `taker` of `takers` equal parts of the samples; the first parts have one sample more where needed.
SampleRange equal_share(const SampleRange& samples, std::uint32_t taker, std::uint32_t takers);

// The number of devices that get work in a render: at most the number of samples or, by rows, of image rows.
std::uint32_t devices_at_work(const PartitionTraits& partition, std::uint32_t devices, std::uint32_t samples,
                              std::uint32_t height);

// The image rows of one device: all rows, or where the partition is by rows every devices-th row.
Rows rows_of(const PartitionTraits& partition, std::uint32_t device, std::uint32_t devices);

// Hands out the samples of one part of a render to devices. Depending on the partition, a device gets its contiguous
// share of them once, or all of them once for its own image rows, or, chunk by chunk, a fraction of those that a shared
// counter has left. May be called by all devices at the same time.
class SampleSource {
public:
    SampleSource(const PartitionTraits& partition, std::uint32_t devices, const SampleRange& samples);

    // The next range of samples that a device shall render; nothing if it has no work left.
    std::optional<SampleRange> next(std::uint32_t device);
    // The most samples per pixel that one call of `next` may hand out.
    std::uint32_t most_at_once() const;

private:
    SampleRange share(std::uint32_t device) const;
    std::uint32_t chunk(std::uint32_t left) const;

    PartitionTraits partition_;
    std::uint32_t devices_;
    SampleRange samples_;
    std::mutex mutex_;
    std::uint32_t taken_ = 0;    // samples handed out from the shared counter
    std::vector<bool> has_had_;  // for each device whether it has had its share of samples
};

}  // namespace pt
