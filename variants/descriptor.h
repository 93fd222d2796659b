// The descriptor of a choice: which axis it is on, what it does and who proposed it, where it applies, what it promises
// about the film, what other choices may ask of it, and how to check afterwards that it did its work.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/config.h"
#include "variants/axes.h"

namespace pt {

// A choice's claim on its film against the reference variant's: the same bits, the same expectation or, declared,
// neither.
enum class Claim { bitwise, statistical, biased };

enum class Backend : std::uint32_t { cpu = 1, cuda = 2 };
inline constexpr Backend all_backends[] = {Backend::cpu, Backend::cuda};

// A set of backends, one bit for each.
using BackendSet = std::uint32_t;
inline constexpr BackendSet on_none = 0;
inline constexpr BackendSet on_cpu = static_cast<BackendSet>(Backend::cpu);
inline constexpr BackendSet on_cuda = static_cast<BackendSet>(Backend::cuda);
inline constexpr BackendSet on_every_backend = on_cpu | on_cuda;
constexpr bool contains(BackendSet set, Backend backend) { return (set & static_cast<BackendSet>(backend)) != 0; }

// A tunable: a number that a choice may be tuned by. It never changes what is computed, unless the choice's claim says
// so.
struct Tunable {
    std::string_view name;
    std::uint32_t default_value = 0;  // value of the tunable where a variant does not set it
    std::uint32_t lowest = 0, highest = 0;
    std::uint32_t multiple_of = 1;
    std::string_view summary = "";
    bool sets_work = false;  // the tunable changes what is computed, not only how fast: autotune leaves it alone
    // Whether the tunable is a shortcut that leaves the film unchanged. The reference variant (Registry::reference)
    // sets it to `lowest`, which turns the shortcut off.
    bool is_shortcut = false;
    // For a tunable that came after its choice was measured: the value at which the choice does what it did without the
    // tunable.
    std::optional<std::uint32_t> as_before = {};
    // The tunable's default beside a generic specialisation, whose kernel has every feature and so is another program.
    std::optional<std::uint32_t> generic_value = {};

    constexpr bool allows(std::uint32_t value) const {
        return value >= lowest && value <= highest && value % multiple_of == 0;
    }
};

// A variant: one choice per axis, in the order of axis_names, and the values of tunables that are not at their default.
class Variant {
public:
    const std::string& operator[](std::string_view axis) const { return choices_.at(index(axis)); }
    void set(std::string_view axis, std::string choice) { choices_.at(index(axis)) = std::move(choice); }
    // Full name of a variant: every choice in the order of the axes, joined by dots, then "+NAME=VALUE" for each
    // tunable that is set. It tells variants apart whatever the baselines are. People are shown shown_name
    // (variant_name.h).
    std::string spelled_out() const;
    bool operator==(const Variant&) const = default;
    bool operator<(const Variant& other) const {
        return choices_ != other.choices_ ? choices_ < other.choices_ : tuning < other.tuning;
    }

    // Position of an axis in axis_names; axis_count if no axis has this name.
    static std::size_t place(std::string_view axis);
    // Position of an axis in axis_names; throws std::out_of_range if no axis has this name.
    static std::size_t index(std::string_view axis);

    std::map<std::string, std::uint32_t, std::less<>> tuning;

private:
    std::vector<std::string> choices_ = std::vector<std::string>(axis_count);
};

// Counters of the work that a render did. A choice checks its own claims against them (Descriptor::check_counters).
struct WorkCounters {
    std::uint64_t paths = 0;
    std::uint64_t rays = 0;  // rays traced; first hits that are taken from the cache do not count
    std::uint64_t unfinished_walks = 0;
    std::uint64_t bounces = 0;  // wavefront iterations over the queue
    std::uint64_t compactions = 0;
    std::uint64_t compacted_away = 0;  // ended paths that compactions took out of the queue
    std::uint64_t last_bounces = 0;    // bounces at a path's last possible segment, which no compaction follows
    std::uint64_t last_paths = 0;      // paths alive at their last possible segment, where all of them end
    std::uint64_t sorts = 0;
    std::uint64_t sorted = 0;  // paths that sorts put in order
    std::uint64_t cache_fills = 0;
    std::uint64_t cache_hits = 0;
    std::uint64_t connections = 0;  // shadow rays traced to lights
    std::uint64_t launches = 0;     // kernels, copies and graphs that the integrator's host side enqueued (CUDA)
    std::uint64_t graph_nodes = 0;  // nodes of the CUDA graphs that were launched
    std::uint64_t loop_rounds = 0;  // rounds that loops within CUDA graphs ran
    std::uint64_t host_waits = 0;   // times that the host waited for the device within the render (CUDA)

    WorkCounters& operator+=(const WorkCounters& other);
};

struct Descriptor {
    std::string_view axis;
    std::string_view name;
    std::string_view summary;       // what the choice is, in one line
    std::string_view origin;        // who proposed the choice, or where it was seen first
    BackendSet baseline = on_none;  // backends on which the choice is the baseline of its axis
    // Backends on which this choice is the reference of its axis, to which bitwise claims are held; an axis without
    // such a choice has the baseline as reference.
    BackendSet reference = on_none;
    Claim claim = Claim::bitwise;
    std::string_view claim_note = "";  // for a statistical or biased claim: what the film is compared with, and why
    // The film of a statistical choice has the expectation of the choice `mean_of` of the same axis at a maximum depth
    // that is greater by mean_at_extra_depth segments.
    std::string_view mean_of = "";
    std::uint32_t mean_at_extra_depth = 0;
    // The compiler may contract and reorder the choice's arithmetic, so two kernels of one formula need not round
    // alike. The film is compared by its mean with that of the variant with the choice `mean_of` instead, which is
    // compared with the reference by bits.
    bool fp_relaxed = false;
    // Whether the film depends on the order in which paths lie in the queue, and so on every other choice. Such a film
    // is compared with the same variant's own film only.
    bool depends_on_order = false;
    // Whether a sampler draws the samples of a pixel independently, so that the error of their mean falls as n^-1/2 and
    // halves of a run are independent.
    bool has_independent_samples = true;
    Traits traits = {};  // what choices of other axes may ask of this choice: the traits of its own axis
    BackendSet backends = on_cpu;
    std::span<const Tunable> tunables = {};
    // Why the choice cannot run on a scene with these features in this variant; empty if it can. The registry adds
    // Reason::axis.
    Reason (*unsupported_reason)(FeatureSet scene, const VariantTraits& variant) = nullptr;
    // What the choice left undone, or did although it must not, by a render's work counters; empty if it did its work.
    std::string (*check_counters)(const WorkCounters& work, std::uint64_t samples) = nullptr;
};

// The traits that a choice declares, or the defaults of its axis if it declares none.
template <class AxisTraits>
constexpr AxisTraits traits_in(const Descriptor& descriptor) {
    const AxisTraits* own = std::get_if<AxisTraits>(&descriptor.traits);
    return own != nullptr ? *own : AxisTraits{};
}

std::string_view to_string(Claim claim);
std::string_view to_string(Backend backend);
// The names of the features in a set, as "axis_box emitter sphere ...".
std::vector<std::string> feature_names(FeatureSet features);

}  // namespace pt
