// What a choice says of itself: which axis it is on, what it does and who proposed it, where it applies, what it
// promises about the image, and how to tell afterwards that it did its work.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/config.h"

namespace pt {

// bitwise: the same film bits as the reference variant. statistical: the same expectation. biased: neither, declared.
enum class Claim { bitwise, statistical, biased };

enum class Backend : std::uint32_t { cpu = 1, cuda = 2 };

// The axes in the order in which a variant's name spells them.
inline constexpr std::string_view axis_names[] = {"integrator",   "compaction", "sorting",       "first_bounce",
                                                  "direct_light", "layout",     "specialisation"};

// One choice per axis, in the order of axis_names. As a string: the choices joined by dots.
class Variant {
public:
    const std::string& operator[](std::string_view axis) const { return choices_.at(index(axis)); }
    void set(std::string_view axis, std::string choice) { choices_.at(index(axis)) = std::move(choice); }
    std::string name() const;
    bool operator==(const Variant&) const = default;
    bool operator<(const Variant& other) const { return choices_ < other.choices_; }

    // Position of an axis; throws std::out_of_range for a name that is none.
    static std::size_t index(std::string_view axis);

private:
    std::vector<std::string> choices_ = std::vector<std::string>(std::size(axis_names));
};

// What a render did, counted where it was done. A choice checks its own claims against it.
struct WorkCounters {
    std::uint64_t paths = 0;
    std::uint64_t rays = 0;  // traced: a first hit that came from the cache is none
    std::uint64_t unfinished_walks = 0;
    std::uint64_t bounces = 0;  // wavefront iterations over the queue
    std::uint64_t compactions = 0;
    std::uint64_t compacted_away = 0;  // ended paths taken out of the queue
    std::uint64_t last_bounces = 0;    // of the bounces, those at the longest path's last segment
    std::uint64_t last_paths = 0;      // paths that were alive there: all of them end in it
    std::uint64_t sorts = 0;
    std::uint64_t sorted = 0;  // paths put in order
    std::uint64_t cache_fills = 0;
    std::uint64_t cache_hits = 0;
    std::uint64_t connections = 0;  // rays to lights
};

struct Descriptor {
    std::string_view axis;
    std::string_view name;
    std::string_view summary;  // one line: what it is
    std::string_view origin;   // who proposed it, or where it was first seen
    bool baseline = false;     // the axis's value where nothing else is asked for
    bool reference =
        false;  // bitwise claims on this axis are held against this choice; where none says so, the baseline
    Claim claim = Claim::bitwise;
    std::string_view claim_note = "";  // for statistical and biased: against what, and why
    // For statistical: the choice of the same axis that has the same expectation, at a depth so many segments greater.
    std::string_view mean_of = "";
    std::uint32_t mean_at_extra_depth = 0;
    bool keeps_payload_contiguous = true;  // of a compaction: the paths in play are slots 0 to count - 1 afterwards
    std::uint32_t backends = static_cast<std::uint32_t>(Backend::cpu);
    // Why the choice cannot run on a scene with these features in this variant; empty: it can.
    std::string (*does_not_apply)(FeatureSet scene, const Variant& variant) = nullptr;
    // What the counters say the choice left undone (or did although it must not); empty: it did its work.
    std::string (*work_missing)(const WorkCounters& work, std::uint64_t samples) = nullptr;
};

std::string_view to_string(Claim claim);
// "axis_box emitter sphere ...": the names of the features in a set, in the order of their bits.
std::vector<std::string> feature_names(FeatureSet features);

}  // namespace pt
