// The values of tunables that were found to be fastest on a machine, by variant: results/MACHINE/tuning.json, written
// by `ptbench autotune` and used by `ptbench run` and `render` where nothing else is asked for. A tuned variant's name
// says so, as the name of every variant with tunables that are not at their default does.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "variants/registry.h"

namespace pt {

struct TunedVariant {
    std::string variant;                          // its name with every tunable at its default, for people
    std::string id;                               // what it is found by (variant_id)
    std::map<std::string, std::uint32_t> values;  // those that are not
    // The scene and settings that were rendered to find the values.
    std::string scene;
    std::uint32_t width = 0, height = 0, depth = 0, spp = 0;
    double standard_ms = 0, tuned_ms = 0;  // a render, medians on the device's clock
};

class Tuning {
public:
    // An absent file is an empty tuning. Throws InputError for a file that is not a tuning.
    static Tuning load(const std::string& file, Backend backend);
    // Replaces the entry of a variant, or adds one.
    void put(const TunedVariant& tuned);
    // Writes the file. Throws MachineError if it cannot be written.
    void save(const std::string& file, const std::string& machine) const;

    // Finds the variant of an identity; null if it was never tuned.
    const TunedVariant* find(const std::string& id) const;
    // The variant with the values found for it, but for tunables in `named` and those that it has a value for already.
    Variant applied(const Variant& variant, const std::set<std::string>& named) const;
    const std::vector<TunedVariant>& entries() const { return entries_; }

private:
    std::vector<TunedVariant> entries_;
    Backend backend_ = Backend::cpu;
};

// The file of tuned values for this machine: results/MACHINE/tuning.json beside scenes/.
std::string tuning_file(Backend backend);

// Values of a tunable worth trying, in increasing order, the standard among them; empty for a tunable that sets what is
// computed.
std::vector<std::uint32_t> candidates(const Tunable& tunable);

}  // namespace pt
