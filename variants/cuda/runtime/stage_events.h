// Stage times on the device: a pair of CUDA events around each stage of an instrumented render, never of a timed one.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

class StageEvents {
public:
    StageEvents() = default;
    ~StageEvents();
    StageEvents(const StageEvents&) = delete;
    StageEvents& operator=(const StageEvents&) = delete;

    void begin(std::string_view stage, cudaStream_t stream);
    void end(cudaStream_t stream);
    // Milliseconds by stage, in order of first use. Waits for the device.
    std::vector<std::pair<std::string_view, double>> milliseconds() const;

private:
    cudaEvent_t record(cudaStream_t stream);

    struct Span {
        std::string_view stage;
        cudaEvent_t begin, end;
    };
    std::vector<Span> spans_;
};

// Times the work of a stage enqueued while the object lives, if the render is instrumented.
class Stage {
public:
    Stage(StageEvents* events, std::string_view stage, cudaStream_t stream) : events_(events), stream_(stream) {
        if (events_ != nullptr) {
            events_->begin(stage, stream_);
        }
    }
    ~Stage() {
        if (events_ != nullptr) {
            events_->end(stream_);
        }
    }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

private:
    StageEvents* events_;
    cudaStream_t stream_;
};

}  // namespace pt::cuda
