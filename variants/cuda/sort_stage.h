// Puts the paths of a queue in order between two of an integrator's kernels. Host side: enqueues work.
#pragma once

#include "variants/cuda/integrator.h"
#include "variants/cuda/queue_chunks.h"
#include "variants/cuda/stages.h"

namespace pt::cuda {

class SortStage {
public:
    // Precondition: `job` and `needs` outlive the stage.
    SortStage(Job& job, const IntegratorNeeds& needs)
        : job_(job), needs_(needs), asked_chunk_(key().by_chunk ? needs.tunable("chunk") : 0) {}

    bool exists() const { return needs_.sorting != nullptr; }
    const SortKeyTraits& key() const { return needs_.traits.sort_key; }

    // Slots in a chunk of the queue, which only the queue's capacity decides; 0: sort keys are not by chunk.
    std::uint32_t chunk(const Queue& queue) const {
        return key().by_chunk ? slots_of_chunk(queue.capacity, job_.materials, asked_chunk_) : 0;
    }
    // The sort key of positions without a live path. There is one material more than the scene has, for "missed".
    std::uint32_t last_key(const Queue& queue) const {
        if (key().by_chunk) {
            return keys_of_chunks(queue.capacity, job_.materials, chunk(queue));
        }
        return (key().has_material ? job_.materials + 1 : 1) << key().bits;
    }
    // Sorts the queue's paths by queue.keys.
    void sort(Queue& queue) {
        needs_.sorting->sort(queue, last_key(queue) + 1);
        job_.work.sorts += 1;
    }
    // Parts of the queue, each shaded by one launch: the whole or, once sorted, the ranges that the sort has made.
    std::vector<ShadeRange> shade_ranges(const Queue& queue, bool is_sorted) const {
        std::vector<ShadeRange> ranges = is_sorted ? needs_.sorting->shade_ranges() : std::vector<ShadeRange>();
        if (ranges.empty()) {
            ranges.push_back({queue.indirect ? queue.order : nullptr, queue.count});
        }
        return ranges;
    }

private:
    Job& job_;
    const IntegratorNeeds& needs_;
    std::uint32_t asked_chunk_;  // slots per chunk that the tunable `chunk` asks for
};

}  // namespace pt::cuda
