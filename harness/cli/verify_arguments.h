// Arguments of `ptbench verify`, and what its checks of films and of means report alike.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/bench/progress.h"
#include "harness/cli/commands.h"
#include "harness/scene/scene_buffers.h"

namespace pt {

struct VerifyArguments {
    std::string scenes;
    std::vector<std::string> axes;
    std::string devices;
    std::vector<std::string> tunables;
    std::string backend;
    std::string resolution;  // an empty resolution, spp 0 or depth 0 means the check's default
    std::uint32_t spp = 0;
    std::uint32_t depth = 0;
    std::uint64_t seed = 1;
    bool quick = false;
    CompileOnly compile_only;
    bool quiet = false;
    std::size_t jobs = 0;  // number of worker processes; 0: as many as speed up the backend
    bool statistical = false;
    std::vector<std::string> against;
    std::uint32_t runs = 16;

    std::string size() const { return !resolution.empty() ? resolution : statistical ? "32x32" : "64x64"; }
    bool names_no_size() const { return resolution.empty() && spp == 0; }
    std::uint32_t samples() const { return spp != 0 ? spp : statistical ? 64 : 4; }
};

RenderSettings settings_of(const Scene& scene, const VerifyArguments& arguments);

struct Tally {
    std::size_t held = 0, failed = 0, not_applicable = 0;
};

// Collects variants that do not apply to a scene and prints one line per reason: in a product of axes most variants do
// not apply, for few reasons.
class NotApplicableLines {
public:
    void add(const std::string& variant, const std::string& reason);
    void print(const std::string& scene) const;
    // The number of variants that were added as not applicable.
    std::size_t variants() const { return variants_; }

private:
    struct Group {
        std::string reason, first;
        std::size_t variants;
    };
    std::vector<Group> groups_;  // variants grouped by reason, in order of their first variants
    std::size_t variants_ = 0;
};

// The progress display of `ptbench verify`; with --quiet it stays hidden for the first seconds.
Progress progress_of(std::size_t steps, const VerifyArguments& arguments);

}  // namespace pt
