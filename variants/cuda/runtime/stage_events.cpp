#include "variants/cuda/runtime/stage_events.h"

#include <algorithm>

namespace pt::cuda {

StageEvents::~StageEvents() {
    for (const Span& span : spans_) {
        (void)cudaEventDestroy(span.begin);
        (void)cudaEventDestroy(span.end);
    }
}

cudaEvent_t StageEvents::record(cudaStream_t stream) {
    cudaEvent_t event = nullptr;
    PT_CUDA_CHECK(cudaEventCreate(&event));
    PT_CUDA_CHECK(cudaEventRecord(event, stream));
    return event;
}

void StageEvents::begin(std::string_view stage, cudaStream_t stream) {
    spans_.push_back({stage, nullptr, nullptr});
    spans_.back().begin = record(stream);
}

void StageEvents::end(cudaStream_t stream) {
    // A stage is left without a time if CUDA cannot record its end: end() runs while exceptions unwind, too.
    cudaEvent_t event = nullptr;
    if (cudaEventCreate(&event) == cudaSuccess) {
        (void)cudaEventRecord(event, stream);
    }
    spans_.back().end = event;
}

std::vector<std::pair<std::string_view, double>> StageEvents::milliseconds() const {
    std::vector<std::pair<std::string_view, double>> times;
    for (const Span& span : spans_) {
        PT_CUDA_CHECK(cudaEventSynchronize(span.end));
        float elapsed = 0;
        PT_CUDA_CHECK(cudaEventElapsedTime(&elapsed, span.begin, span.end));
        auto position =
            std::find_if(times.begin(), times.end(), [&](const auto& entry) { return entry.first == span.stage; });
        if (position == times.end()) {
            position = times.insert(times.end(), {span.stage, 0.0});
        }
        position->second += elapsed;
    }
    return times;
}

}  // namespace pt::cuda
