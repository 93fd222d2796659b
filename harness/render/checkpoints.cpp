#include "harness/render/checkpoints.h"

#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt {

std::vector<RenderPart> parts_of(const RenderRequest& request) {
    if (request.checkpoints.empty()) {
        return {{0, request.samples}};
    }
    std::vector<RenderPart> parts;
    std::uint32_t done = 0;
    for (const std::uint32_t checkpoint : request.checkpoints) {
        if (checkpoint <= done) {
            throw std::logic_error(
                fmt::format("checkpoints at {} samples do not increase", fmt::join(request.checkpoints, ", ")));
        }
        parts.push_back({done, checkpoint - done});
        done = checkpoint;
    }
    if (done != request.samples) {
        throw std::logic_error(
            fmt::format("the last checkpoint is at {} of the render's {} samples", done, request.samples));
    }
    return parts;
}

bool stops_change_film(const Variant& variant, Backend backend) {
    return depends_on_order(variant, backend) || traits_of(variant, backend).robustness.is_naive;
}

bool is_shown(const RenderRequest& request) { return !request.checkpoints.empty() && request.on_checkpoint != nullptr; }

void report_checkpoint(const RenderRequest& request, const RenderPart& part, RenderResult& result) {
    if (!is_shown(request)) {
        return;
    }
    const std::uint64_t samples = result.film.samples();
    const std::uint32_t so_far = part.done + part.samples;
    result.film.set_samples(so_far);
    request.on_checkpoint({so_far, result.wall_ms, result.device_ms, result.cpu_ms, result.film});
    result.film.set_samples(samples);
}

}  // namespace pt
