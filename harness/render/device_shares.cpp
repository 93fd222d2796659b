#include "harness/render/device_shares.h"

#include <algorithm>

namespace pt {

std::uint32_t devices_at_work(const PartitionTraits& partition, std::uint32_t devices, std::uint32_t samples,
                              std::uint32_t height) {
    return std::max(1u, std::min(devices, partition.is_by_rows ? height : samples));
}

Rows rows_of(const PartitionTraits& partition, std::uint32_t device, std::uint32_t devices) {
    return partition.is_by_rows ? Rows{device, devices} : Rows{};
}

SampleRange equal_share(const SampleRange& samples, std::uint32_t taker, std::uint32_t takers) {
    const std::uint32_t each = samples.count / takers;
    const std::uint32_t more = samples.count % takers;
    return {samples.first + taker * each + std::min(taker, more), each + (taker < more ? 1u : 0u)};
}

SampleSource::SampleSource(const PartitionTraits& partition, std::uint32_t devices, const SampleRange& samples)
    : partition_(partition), devices_(devices), samples_(samples), has_had_(devices) {}

SampleRange SampleSource::share(std::uint32_t device) const {
    return partition_.is_by_rows ? samples_ : equal_share(samples_, device, devices_);
}

// Number of samples that a device takes next from the shared counter: half of an equal share of those left, so that all
// devices end together, but at least a sixteenth of a device's share, up to 16 samples, so that launches cost little.
std::uint32_t SampleSource::chunk(std::uint32_t left) const {
    constexpr std::uint32_t least_samples = 16, least_share = 16;
    const std::uint32_t least = std::clamp(samples_.count / (least_share * devices_), 1u, least_samples);
    const std::uint32_t half_of_share = left / (2 * devices_) / least * least;
    return std::min(left, std::max(least, half_of_share));
}

std::uint32_t SampleSource::most_at_once() const {
    return partition_.is_dynamic ? std::max(1u, chunk(samples_.count)) : std::max(1u, share(0).count);
}

std::optional<SampleRange> SampleSource::next(std::uint32_t device) {
    const std::lock_guard lock(mutex_);
    if (partition_.is_dynamic) {
        const std::uint32_t count = chunk(samples_.count - taken_);
        const SampleRange range{samples_.first + taken_, count};
        taken_ += count;
        return count > 0 ? std::optional(range) : std::nullopt;
    }
    const SampleRange range = share(device);
    const bool is_new = !has_had_.at(device);
    has_had_.at(device) = true;
    return is_new && range.count > 0 ? std::optional(range) : std::nullopt;
}

}  // namespace pt
