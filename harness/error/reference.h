// Reference images: two independent halves, rendered until accurate enough by a variant that shares as little as
// possible with those measured, or a closed form. Rendered halves are cached on disk.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "harness/error/metrics.h"
#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// The mean radiance of a film in double precision.
Image image_of(const Film& film);

// A variance limit that every reference meets, for tasks where ReferenceNoise::dual_error alone decides.
inline constexpr double any_variance = 1e300;

// Describes a reference image to be made and the accuracy that it needs.
struct ReferenceTask {
    std::shared_ptr<const Scene> scene;
    std::uint32_t width = 0, height = 0, depth = 0;
    Backend backend = Backend::cpu;
    std::map<std::string, std::string> axes = {};  // choices by axis that replace those of reference_variant
    double variance = 0;                           // largest allowed variance per pixel and channel
    std::uint64_t most_spp = 1;                    // largest samples per pixel of each half
    // The reference's name, "cornell_open/64x64/depth:8/cpu", followed by "/AXIS=CHOICE" for each of `axes`.
    std::string name() const;
};

struct Reference {
    std::string name;
    std::string scene, scene_hash;
    std::uint32_t width = 0, height = 0, depth = 0;
    bool is_closed_form = false;
    std::string formula;             // formula of the image if it has a closed form, else empty
    std::uint64_t spp_per_half = 0;  // samples per pixel of each half; 0 for a closed form
    std::string variant, variant_id, backend;
    std::uint64_t seeds[2] = {0, 0};
    std::string git_sha;
    Image first, second;  // images of both halves; equal for a closed form
    ReferenceNoise noise;
    std::string hash;  // hash of the bits of both halves

    Json provenance() const;
    Image mean() const;
};

// The variant that renders a reference, as different as possible from those measured: plainest choices on every axis,
// and where backend and scene allow depth_first or megakernel, the kernel with all features, Philox and double
// precision. The choices in `task.axes` may not apply to the scene.
Variant reference_variant(const ReferenceTask& task);

// The depth at which a variant has the expectation of plain paths of length `depth`: less the segments by which its
// choices look ahead (Descriptor::mean_at_extra_depth). 0 if there is no such depth.
std::uint32_t depth_for_mean_of(const Variant& variant, Backend backend, std::uint32_t depth);

// The seeds of a reference's two halves, which no other render uses.
inline constexpr std::uint64_t reference_seeds[2] = {7'393'913'000'000'001, 7'393'913'000'000'002};

class ReferenceMaker {
public:
    // Functions that a maker calls: `is_stopped` between renders (if it returns true, the reference image stays as
    // noisy as it is), and `says` with a line of text after each slow step and when a cached file is refused.
    struct Hooks {
        std::function<bool()> is_stopped = [] { return false; };
        std::function<void(const std::string&)> says = [](const std::string&) {};
    };

    // A maker of reference images that caches them in `folder`; an empty `folder` disables the cache.
    explicit ReferenceMaker(std::string folder) : ReferenceMaker(std::move(folder), Hooks{}) {}
    ReferenceMaker(std::string folder, Hooks hooks) : folder_(std::move(folder)), hooks_(std::move(hooks)) {}

    // Makes a reference: a closed form if there is one, else rendered halves, from the cache if possible. Samples are
    // doubled until the variance is at most the task's and dual_error at most `dual_error`, or the halves have
    // most_spp. Throws std::runtime_error if a render has samples that are not finite, negative or saturated.
    Reference make(const ReferenceTask& task, double dual_error = 1e300) const;

private:
    std::string folder_;
    Hooks hooks_;
};

// The default cache folder for references: $XDG_CACHE_HOME/ptbench/references, or below ~/.cache.
std::string default_reference_folder();

}  // namespace pt
