// What images are compared with: two independent halves, rendered by a route that shares as little as possible with
// what is measured and until they are accurate enough, or a closed form. Rendered halves stay in a cache on disk.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "harness/error/metrics.h"
#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// The film's means in double.
Image image_of(const Film& film);

// A variance that every reference has: what decides is the error that it leaves (ReferenceNoise::dual_error).
inline constexpr double any_variance = 1e300;

// The image that a reference is of, and how well it is to be known.
struct ReferenceTask {
    std::shared_ptr<const Scene> scene;
    std::uint32_t width = 0, height = 0, depth = 0;
    Backend backend = Backend::cpu;
    std::map<std::string, std::string> axes = {};  // choices that take the place of reference_variant's own
    double variance = 0;                           // of the mean of the halves, a pixel and channel
    std::uint64_t most_spp = 1;                    // of each half
    // The task's name, as "cornell_open/64x64/depth:8/cpu", and "/AXIS=CHOICE" for each of `axes`.
    std::string name() const;
};

struct Reference {
    std::string name;
    std::string scene, scene_hash;
    std::uint32_t width = 0, height = 0, depth = 0;
    bool is_closed_form = false;
    std::string formula;             // of a closed form
    std::uint64_t spp_per_half = 0;  // this and what follows: of a rendered reference
    std::string variant, variant_id, backend;
    std::uint64_t seeds[2] = {0, 0};
    std::string git_sha;
    Image first, second;  // of a closed form both are the same
    ReferenceNoise noise;
    std::string hash;  // of the halves' bits

    Json provenance() const;
    Image mean() const;
};

// The variant that a reference is made with, as far from what is measured as the program goes: every axis at its
// plainest, and where the backend has them and the scene allows them depth_first or megakernel, the kernel with
// everything, Philox and double precision. The task's own choices may not apply to its scene.
Variant reference_variant(const ReferenceTask& task);

// The depth at which a variant has the expectation of plain paths of `depth`: smaller by the segments that its choices
// look ahead (Descriptor::mean_at_extra_depth). 0: no depth has it.
std::uint32_t depth_for_mean_of(const Variant& variant, Backend backend, std::uint32_t depth);

// Seeds of the two halves; no other render uses them.
inline constexpr std::uint64_t reference_seeds[2] = {7'393'913'000'000'001, 7'393'913'000'000'002};

class ReferenceMaker {
public:
    // `is_stopped` is asked between renders; where it says yes, what is there is returned. `says` gets one line after
    // every step that took a while, and where a cached file is refused.
    struct Hooks {
        std::function<bool()> is_stopped = [] { return false; };
        std::function<void(const std::string&)> says = [](const std::string&) {};
    };

    // Makes references, and keeps them in `folder`; if that is empty, nothing is kept.
    explicit ReferenceMaker(std::string folder) : ReferenceMaker(std::move(folder), Hooks{}) {}
    ReferenceMaker(std::string folder, Hooks hooks) : folder_(std::move(folder)), hooks_(std::move(hooks)) {}

    // The closed form, or the halves: those of the cache if there are any, with samples doubled until their variance is
    // no more than the task's and their dual_error no more than `dual_error`, or they have most_spp. Throws
    // std::runtime_error if a render has samples that are not finite, negative or saturated.
    Reference make(const ReferenceTask& task, double dual_error = 1e300) const;

private:
    std::string folder_;
    Hooks hooks_;
};

// The folder of kept references: $XDG_CACHE_HOME/ptbench/references, or below ~/.cache.
std::string default_reference_folder();

}  // namespace pt
