// What the integrators that keep their paths in registers have in common on the host's side: what they cannot be
// combined with, what their counters must say, and their loop over a render's samples.
#pragma once

#include <algorithm>

#include "variants/cuda/integrator.h"
#include "variants/no_queue.h"
#include "variants/registry.h"

namespace pt::cuda {

inline constexpr Tunable block_tunable{"block", 128, 32, 1024, 32, "threads a block"};
inline constexpr Tunable shading_tunable{
    "shading_fmas",
    0,
    0,
    1048576,
    1,
    "injected cost of a material: dependent multiply-adds, executed material by material",
    true};

inline constexpr Tunable min_blocks_tunable{
    "min_blocks",
    0,
    0,
    32,
    1,
    "blocks that a multiprocessor must hold at once: bounds a thread's registers; half as many in "
    "double precision; 0: no bound"};
inline constexpr Tunable regeneration_tunable{
    "regenerate_at", 24, 0, 31, 1, "ended paths of a warp are replaced once no more lanes than this are alive"};

inline constexpr Tunable megakernel_tunables[] = {
    block_tunable,
    shading_tunable,
    min_blocks_tunable,
    {"spp_in_flight", 1, 1, 1048576, 1, "threads a pixel, each with its share of the samples"}};
inline constexpr Tunable piece_tunable{"piece", 16, 1,
                                       4096,    1,  "samples of a strip of 32 pixels that a warp takes at a time"};
inline constexpr Tunable persistent_tunables[] = {block_tunable, shading_tunable, min_blocks_tunable,
                                                  regeneration_tunable, piece_tunable};

inline std::vector<KernelConstant> regeneration_constants(const Variant& variant) {
    return {{"regenerate_at", tunable(variant, "regenerate_at", Backend::cuda)}};
}

inline Reason megakernel_unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (Reason reason = needs_no_queue(variant, "keeps one path in registers"); !reason.empty()) {
        return reason;
    }
    if (variant.launch.is_captured) {
        return {"nothing_to_capture",
                "is one kernel, nothing to capture: needs launch=stream, not " + std::string(variant.launch.name)};
    }
    return {};
}

inline std::string megakernel_work_missing(const WorkCounters& work, std::uint64_t) {
    if (work.bounces != 0) {
        return "ran a queue";
    }
    return work.launches == 0 ? "launched no kernel" : "";
}

// Samples of a pixel that one launch may take when this many threads share them, so that a thread's and a block's
// counters fit in 32 bits.
inline std::uint32_t samples_per_launch(const Job& job, std::uint32_t threads_per_pixel) {
    // Bound on a sample's rays: each branch of a path traces a segment and at most one connection at each step.
    const std::uint64_t rays_per_sample = 2ull * job.longest_path * job.most_branches;
    const std::uint64_t a_thread = std::max<std::uint64_t>(1, 0xffffffffull / (rays_per_sample * job.block));
    const std::uint64_t threads = std::min(threads_per_pixel, job.samples);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(a_thread * threads, 1, job.samples));
}

// Base class of integrators with one kernel: launch after launch, each with as many of a render's samples per pixel as
// a launch may take.
template <class Real>
class Megakernel : public Integrator {
public:
    explicit Megakernel(JobOf<Real>& job) : job_(job) {}

    void render() final {
        fill_cache(job_);
        const Stage stage(job_.stages, "trace", job_.stream);
        const std::uint32_t most = most_samples();
        for (std::uint32_t done = 0; done < job_.samples;) {
            const std::uint32_t samples = std::min(most, job_.samples - done);
            launch(job_.first_sample + done, samples);
            done += samples;
        }
    }

protected:
    // Most samples of a pixel that one launch of the kernel may take.
    virtual std::uint32_t most_samples() const = 0;
    virtual void launch(std::uint32_t first_sample, std::uint32_t samples) = 0;

    JobOf<Real>& job_;
};

// A megakernel whose threads share the samples of a pixel (tunable spp_in_flight): `stride` threads a pixel.
template <class Real>
class StridedMegakernel : public Megakernel<Real> {
public:
    StridedMegakernel(JobOf<Real>& job, const IntegratorNeeds& needs)
        : Megakernel<Real>(job), threads_per_pixel_(std::min(needs.tunable("spp_in_flight"), job.all_samples)) {}

protected:
    virtual void launch_strided(std::uint32_t first_sample, std::uint32_t samples, std::uint32_t stride) = 0;

private:
    std::uint32_t most_samples() const final { return samples_per_launch(this->job_, threads_per_pixel_); }
    void launch(std::uint32_t first_sample, std::uint32_t samples) final {
        launch_strided(first_sample, samples, std::min(threads_per_pixel_, samples));
    }

    std::uint32_t threads_per_pixel_;
};

}  // namespace pt::cuda
