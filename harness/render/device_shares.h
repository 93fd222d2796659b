// What of a render each of several devices takes: arithmetic of samples and rows, without a device.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "variants/axes.h"

namespace pt {

// Rows of an image: first, first + step, first + 2 step, ...
struct Rows {
    std::uint32_t first = 0, step = 1;

    std::uint32_t count(std::uint32_t height) const { return first < height ? (height - first - 1) / step + 1 : 0; }
    bool operator==(const Rows&) const = default;
};

// A range of samples of every pixel, from `first` on.
struct SampleRange {
    std::uint32_t first = 0, count = 0;
    bool operator==(const SampleRange&) const = default;
};

// The part that number `taker` of `takers` has of the samples: as many as any other's or one more, which the first
// have.
SampleRange equal_share(const SampleRange& samples, std::uint32_t taker, std::uint32_t takers);

// The devices that have anything to do: no more than there are samples, or rows.
std::uint32_t devices_at_work(const PartitionTraits& partition, std::uint32_t devices, std::uint32_t samples,
                              std::uint32_t height);

// The rows of device `device` of `devices`.
Rows rows_of(const PartitionTraits& partition, std::uint32_t device, std::uint32_t devices);

// Hands out the samples of one part of a render, by partition: to a device its contiguous share, once; to one that has
// rows of its own all of them, once; or, of a counter that all devices share, chunk after chunk, each a part of what is
// left. Devices ask at the same time.
class SampleSource {
public:
    SampleSource(const PartitionTraits& partition, std::uint32_t devices, const SampleRange& samples);

    // The samples that a device is to take next; nothing: it is done.
    std::optional<SampleRange> next(std::uint32_t device);
    // The most samples that `next` may hand out at once.
    std::uint32_t most_at_once() const;

private:
    SampleRange share(std::uint32_t device) const;
    std::uint32_t chunk(std::uint32_t left) const;

    PartitionTraits partition_;
    std::uint32_t devices_;
    SampleRange samples_;
    std::mutex mutex_;
    std::uint32_t taken_ = 0;    // of a shared counter
    std::vector<bool> has_had_;  // its share, by device
};

}  // namespace pt
