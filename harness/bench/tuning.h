// Tuned values of tunables, the fastest ones found on a machine for each variant: results/MACHINE/tuning.json, written
// by `ptbench autotune` and used by `ptbench run` and `render` for tunables that the user does not set. The name of a
// variant shows every tunable that is not at its default.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "variants/registry.h"

namespace pt {

struct TunedVariant {
    std::string variant;                          // the variant's name with all tunables at their defaults
    std::string id;                               // identity by which an entry is found (variant_id)
    std::map<std::string, std::uint32_t> values;  // tuned values that differ from the defaults
    std::string scene;
    std::uint32_t width = 0, height = 0, depth = 0, spp = 0;
    double standard_ms = 0, tuned_ms = 0;  // median device times of a render in ms, with default and tuned values
};

class Tuning {
public:
    // Loads a tuning file; a missing file gives an empty tuning. Throws InputError for a malformed file.
    static Tuning load(const std::string& file, Backend backend);
    // Adds the entry of a tuned variant, or replaces it.
    void put(const TunedVariant& tuned);
    // Writes the tuning file. Throws MachineError if it cannot be written.
    void save(const std::string& file, const std::string& machine) const;

    // The tuning file's entry with this variant identity; null if that variant was never tuned.
    const TunedVariant* find(const std::string& id) const;
    // A variant with the tuned values of its entry in the file, but not of tunables in `named` or with a value already.
    Variant applied(const Variant& variant, const std::set<std::string>& named) const;
    const std::vector<TunedVariant>& entries() const { return entries_; }

private:
    std::vector<TunedVariant> entries_;
    Backend backend_ = Backend::cpu;
};

// The file of tuned values for this machine: results/MACHINE/tuning.json beside scenes/.
std::string tuning_file(Backend backend);

// Values of a tunable that autotune tries, in increasing order, the standard included; none for a tunable that changes
// the computed result.
std::vector<std::uint32_t> candidates(const Tunable& tunable);

}  // namespace pt
