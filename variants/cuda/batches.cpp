#include "variants/cuda/batches.h"

#include <algorithm>
#include <utility>

#include "variants/cuda/queue_kernels.h"
#include "variants/cuda/runtime/handles.h"

namespace pt::cuda {

void Batches::reserve(Arena& arena) {
    next_sample_ = arena.take<std::uint32_t>(1);
    offset_ = arena.take<std::uint32_t>(1);
    rounds_ = arena.take<std::uint64_t>(1);
}

void Batches::clear() {
    cuda::clear(offset_, sizeof *offset_, job_.stream);
    cuda::clear(rounds_, sizeof *rounds_, job_.stream);
}

void Batches::prepare(const Enqueue& enqueue) {
    if (!launch_.is_captured || job_.stages != nullptr) {  // the CUDA events that time stages cannot be captured
        return;
    }
    PT_CUDA_CHECK(cudaMemcpyAsync(next_sample_, &job_.first_sample, sizeof job_.first_sample, cudaMemcpyHostToDevice,
                                  job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    graph_sample_ = job_.first_sample;
    graph_ = std::make_unique<Graph>(job_.stream);
    const WorkCounters before = std::exchange(job_.work, {});
    is_capturing_ = true;
    graph_->capture([&] {
        enqueue(job_.first_sample, samples_in_flight_);
        job_.launch_blocks(1, AdvanceParameters{next_sample_, samples_in_flight_});
    });
    is_capturing_ = false;
    work_per_graph_ = std::exchange(job_.work, before);
    work_per_graph_.launches = 1;
    work_per_graph_.graph_nodes = graph_->nodes();
}

// Launches a batch as a CUDA graph, whose every launch goes on at the sample where the launch before ended.
void Batches::launch_graph(std::uint32_t sample) {
    if (graph_sample_ != sample) {
        set_value(next_sample_, sample, job_.stream);
        job_.work.launches += 1;
    }
    graph_->launch();
    job_.work += work_per_graph_;
    graph_sample_ = sample + samples_in_flight_;
}

void Batches::run(const Enqueue& enqueue) {
    for (std::uint32_t done = 0; done < job_.samples;) {
        const std::uint32_t batch = std::min(samples_in_flight_, job_.samples - done);
        if (graph_ != nullptr && batch == samples_in_flight_) {
            launch_graph(job_.first_sample + done);
        } else {
            enqueue(job_.first_sample + done, batch);
        }
        done += batch;
    }
}

std::uint32_t Batches::enqueue_loop(const std::function<LiveCounts()>& enqueue_round) {
    if (!launch_.loops || !is_capturing_ || job_.longest_path < segments_per_round + 2) {
        return 0;
    }
    const std::uint32_t taken = (job_.longest_path - 2) / segments_per_round * segments_per_round;
    const WorkCounters before = std::exchange(job_.work, {});
    is_in_loop_ = true;
    graph_->capture_loop([&](cudaGraphConditionalHandle condition) {
        const LiveCounts live = enqueue_round();
        end_round(condition, live, offset_, taken, rounds_, job_.stream);
    });
    is_in_loop_ = false;
    work_per_round_ = std::exchange(job_.work, before);
    work_per_round_.launches = 0;  // the device, not the host, launches the rounds of the graph's loop
    return taken;
}

WorkCounters Batches::loop_work() const {
    std::uint64_t rounds = 0;
    PT_CUDA_CHECK(cudaMemcpyAsync(&rounds, rounds_, sizeof rounds, cudaMemcpyDeviceToHost, job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    WorkCounters work;
    for (std::uint64_t round = 0; round < rounds; ++round) {
        work += work_per_round_;
    }
    work.loop_rounds = rounds;
    return work;
}

}  // namespace pt::cuda
