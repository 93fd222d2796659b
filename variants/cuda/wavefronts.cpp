#include "variants/cuda/wavefronts.h"

#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "variants/work_checks.h"

namespace pt::cuda {

namespace {

constexpr std::size_t pinned_words = 64;

// Throws std::logic_error unless the body of a graph's loop leaves the queue's buffers as it found them.
void check_round_trip(const Queue& before, const Queue& after) {
    if (before.paths.base != after.paths.base || before.hits != after.hits || before.order != after.order ||
        before.keys != after.keys || before.count != after.count || before.bound != after.bound ||
        before.indirect != after.indirect) {
        throw std::logic_error("a round of the graph's loop leaves the queue otherwise than it found it");
    }
}

}  // namespace

// Asks whether all paths of a batch have ended, by the device's count of the paths that a segment finds alive. To be
// made before the segment is enqueued. The counts are copied to the pinned words of the compaction's read-back, which
// does not take place where this class asks.
class Wavefront::EndOfPaths {
public:
    EndOfPaths(Wavefront& wavefront, std::uint32_t segment)
        : job_(wavefront.job_),
          asks_(asks_for_the_end(job_, wavefront.reads_back_ && wavefront.needs_.compaction != nullptr,
                                 wavefront.batches_.is_capturing(), segment)),
          live_(job_.segments.live + segment),
          counts_(reinterpret_cast<std::uint64_t*>(wavefront.pinned_.get())) {
        if (asks_) {
            read(0);
        }
    }
    // Whether the queue held no path in the segment, once the segment has been enqueued.
    bool is_reached() {
        if (!asks_) {
            return false;
        }
        read(1);
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        job_.work.host_waits += 1;
        return counts_[0] == counts_[1];  // read before and after the segment: the counter spans batches
    }

private:
    void read(int i) {
        PT_CUDA_CHECK(cudaMemcpyAsync(counts_ + i, live_, sizeof *live_, cudaMemcpyDeviceToHost, job_.stream));
    }

    Job& job_;
    bool asks_;
    const std::uint64_t* live_;
    std::uint64_t* counts_;
};

Wavefront::Wavefront(Job& job, IntegratorNeeds&& needs, std::size_t real_bytes, std::size_t hit_bytes)
    : appends_(needs.traits.integrator.appends_itself ||
               (needs.traits.integrator.appends_in_kernel && needs.traits.compaction.can_append_in_kernel())),
      job_(job),
      needs_(std::move(needs)),
      real_bytes_(real_bytes),
      hit_bytes_(hit_bytes),
      batches_(job, std::min(needs_.tunable("spp_in_flight"), job.all_samples), needs_.traits.launch),
      reads_back_(!needs_.traits.integrator.refills_queue && !needs_.traits.integrator.appends_itself &&
                  needs_.tunable("read_back") != 0),
      pinned_(make_pinned_words(pinned_words)) {}

// ---- the loop over the segments of a batch

void Wavefront::prepare() {
    batches_.prepare([this](std::uint32_t first_sample, std::uint32_t samples) { enqueue(first_sample, samples); });
}

void Wavefront::render() {
    fill_first_hits();
    batches_.run([this](std::uint32_t first_sample, std::uint32_t samples) { enqueue(first_sample, samples); });
}

void Wavefront::start_queue(std::uint32_t paths) {
    queue_ = start_;
    queue_.bound = paths;
}

// Enqueues one batch: every path of it from its camera ray to its end.
void Wavefront::enqueue(std::uint32_t first_sample, std::uint32_t samples) {
    start_queue(job_.pixels * samples);
    begin(first_sample);
    for (std::uint32_t segment = 1 + batches_.enqueue_loop([this] { return enqueue_round(); });
         segment < job_.longest_path && queue_.bound > 0; ++segment) {
        EndOfPaths end(*this, segment);
        trace(segment);
        end_segment(segment);
        if (end.is_reached()) {
            break;
        }
    }
}

LiveCounts Wavefront::enqueue_round() {
    const Queue before = queue_;
    for (const std::uint32_t segment : {1u, 2u}) {
        trace(segment);
        end_segment(segment);
    }
    const LiveCounts live = end_round(before);
    check_round_trip(before, queue_);
    return live;
}

LiveCounts Wavefront::end_round(const Queue&) { return {.counts = queue_.count}; }

void Wavefront::end_segment(std::uint32_t segment) {
    job_.work.bounces += 1;
    job_.work.last_bounces += is_last(segment) ? 1u : 0u;
    if (needs_.compaction != nullptr && !is_last(segment)) {
        compact();
    }
}

// Compacts the queue. The host learns the count of paths in play if the compaction reads it back.
void Wavefront::compact() {
    const Stage stage(job_.stages, "compact", job_.stream);
    const std::uint32_t before = queue_.bound;
    if (!appends_) {
        needs_.compaction->compact(queue_);
        check_count_after("compaction", before, queue_.bound);
    }
    job_.work.compactions += 1;
    if (reads_back_) {
        std::uint32_t* const counts = pinned_.get();
        PT_CUDA_CHECK(cudaMemcpy2DAsync(counts, sizeof(std::uint32_t), queue_.count,
                                        counter_stride * sizeof(std::uint32_t), sizeof(std::uint32_t), parts(),
                                        cudaMemcpyDeviceToHost, job_.stream));
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        const std::uint64_t count = std::accumulate(counts, counts + parts(), std::uint64_t{0});
        check_count_after("compaction", before, count);
        queue_.bound = static_cast<std::uint32_t>(count);
        job_.work.host_waits += 1;
    }
}

// ---- the queue's memory: how many paths it holds, what each of them carries, and what the compaction and the sorting
// need beside the paths

bool Wavefront::copies_whole_paths() const {
    return (needs_.compaction != nullptr && !appends_ && needs_.compaction->moves_paths()) ||
           (needs_.sorting != nullptr && needs_.sorting->moves_paths());
}

// Where the queue is refilled, the paths of a pass are of several segments, whose numbers nobody counts apart.
LeastTraffic Wavefront::least_traffic() const {
    LeastTraffic traffic{.samples_in_flight = batches_.samples_in_flight()};
    if (needs_.traits.integrator.refills_queue) {
        return traffic;
    }
    constexpr double sector_bytes = 32;  // the least that is read of memory at once
    const double stride = needs_.layout.segment(start_.paths, real_bytes_).stride;
    const std::size_t carried = needs_.layout.bytes(start_.capacity, real_bytes_, PathFields::of(needs_.features));
    const BytesOfAPath path{.state = static_cast<double>(carried) / start_.capacity,
                            .liveness = std::min(stride, sector_bytes),
                            .hit = static_cast<double>(hit_bytes_)};
    if (needs_.compaction != nullptr && !appends_) {
        traffic.by_stage["compact"] = needs_.compaction->least_bytes(path);
    }
    if (needs_.sorting != nullptr) {
        traffic.by_stage["sort"] = needs_.sorting->least_bytes(path);
    }
    return traffic;
}

std::uint32_t Wavefront::capacity() const {
    const std::uint64_t pool = std::uint64_t{job_.pixels} * batches_.samples_in_flight();
    if (pool > 0x7fffffffu) {
        throw Error(fmt::format("{} paths in flight: spp_in_flight is too large for {} pixels", pool, job_.pixels));
    }
    return appends_ ? slots_for(static_cast<std::uint32_t>(pool)) : static_cast<std::uint32_t>(pool);
}

std::uint32_t Wavefront::slots_for(std::uint32_t paths) const {
    // Each part of the queue must hold all paths of the thread blocks that append to it.
    const std::uint64_t blocks = (std::uint64_t{paths} + job_.block - 1) / job_.block;
    const std::uint64_t blocks_per_part = (blocks + parts() - 1) / parts();
    return static_cast<std::uint32_t>(blocks_per_part * parts() * job_.block);
}

void Wavefront::reserve_order(Arena& arena) {
    if (needs_.compaction != nullptr || needs_.sorting != nullptr) {
        start_.order = arena.take<std::uint32_t>(start_.capacity);
        start_.order_spare = arena.take<std::uint32_t>(start_.capacity);
    }
    if (needs_.sorting != nullptr) {
        start_.keys = arena.take<std::uint32_t>(start_.capacity);
        start_.keys_spare = arena.take<std::uint32_t>(start_.capacity);
    }
}

void Wavefront::reserve(Arena& arena) {
    batches_.reserve(arena);
    const std::size_t before = arena.used();
    start_.capacity = capacity();
    // A store holds the fields that the kernels write, or all fields if somebody copies whole paths.
    const PathFields carried = copies_whole_paths() ? every_path_field : PathFields::of(needs_.features);
    const std::size_t store_bytes = needs_.layout.bytes(start_.capacity, real_bytes_, carried);
    path_bytes_.state = store_bytes / start_.capacity;
    const auto take_paths = [&]() -> PathStore { return {arena.take_bytes(store_bytes), start_.capacity}; };
    start_.paths = take_paths();
    const bool sort_copies = needs_.sorting != nullptr && needs_.sorting->needs_spare_paths();
    if (appends_ || sort_copies || (needs_.compaction != nullptr && needs_.compaction->needs_spare_paths())) {
        start_.spare = take_paths();
    }
    if (hit_bytes_ != 0) {
        start_.hits = arena.take_bytes(start_.capacity * hit_bytes_);
        start_.hits_spare = sort_copies ? arena.take_bytes(start_.capacity * hit_bytes_) : nullptr;
    }
    reserve_order(arena);
    reserve_counts(arena);
    start_.count = arena.take<std::uint32_t>(1);
    start_.count_spare = arena.take<std::uint32_t>(1);
    start_.bound = start_.capacity;
    start_.object_class = arena.take<unsigned char>(needs_.object_class.size());
    if (needs_.compaction != nullptr && !appends_) {
        needs_.compaction->reserve(arena, start_);
    }
    if (needs_.sorting != nullptr) {
        needs_.sorting->reserve(arena, start_);
    }
    path_bytes_.everything = (arena.used() - before) / (std::size_t{job_.pixels} * batches_.samples_in_flight());
}

void Wavefront::upload() {
    batches_.clear();
    // Index arrays are cleared, for sorts carry along the positions beyond the count, though nobody looks at what they
    // hold.
    for (std::uint32_t* const index : {start_.order, start_.order_spare, start_.keys, start_.keys_spare}) {
        clear(index, std::size_t{start_.capacity} * sizeof(std::uint32_t), job_.stream);
    }
    if (copies_whole_paths()) {
        // The whole store of paths is cleared, since fields that the scene's kernels never write are copied, too.
        clear(start_.paths.base, needs_.layout.bytes(start_.capacity, real_bytes_, every_path_field), job_.stream);
    }
    clear(start_.count, sizeof(std::uint32_t), job_.stream);
    clear(start_.count_spare, sizeof(std::uint32_t), job_.stream);
    PT_CUDA_CHECK(cudaMemcpyAsync(const_cast<unsigned char*>(start_.object_class), needs_.object_class.data(),
                                  needs_.object_class.size(), cudaMemcpyHostToDevice, job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
}

}  // namespace pt::cuda
