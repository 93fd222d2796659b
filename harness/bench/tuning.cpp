#include "harness/bench/tuning.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "harness/bench/suite.h"
#include "harness/cuda/backend.h"
#include "harness/json_reader.h"
#include "harness/machine/machine.h"
#include "harness/scene/places.h"
#include "harness/text_file.h"
#include "harness/write_file.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// The identity of a variant in an old tuning file without identities, whose name spells out all choices with dots.
std::string id_of_spelled_out(const JsonValue& name, Backend backend) {
    Variant variant;
    std::istringstream choices(name.text());
    std::string choice;
    std::size_t count = 0;
    for (; std::getline(choices, choice, '.'); ++count) {
        if (count < axis_count) {
            variant.set(axis_names[count], choice);
        }
    }
    // A variant's name with choices on the first 14 axes gets on later axes the choice that changes nothing
    // (`as_before`). A name with fewer would silently match no variant; programs with more axes write identities.
    constexpr std::size_t spelled_axes = 14;
    for (std::size_t i = count; count == spelled_axes && i < axis_count; ++i) {
        variant.set(axis_names[i], std::string(axis_table[i].as_before));
    }
    if (count != spelled_axes && count != axis_count) {
        name.fail(fmt::format("a variant's name with a choice for each of the {} axes (run ptbench autotune anew)",
                              spelled_axes));
    }
    return variant_id(variant, backend);
}

TunedVariant read_entry(const JsonValue& value, Backend backend) {
    const JsonObject object(
        value, {"variant", "variant_id", "tunables", "scene", "resolution", "depth", "spp", "standard_ms", "tuned_ms"});
    constexpr long long most = 0xffffffffll;
    const auto whole = [&](const JsonValue& number) {
        return static_cast<std::uint32_t>(number.whole(0, most, "a whole number"));
    };
    TunedVariant entry;
    entry.variant = object.required("variant").text();
    entry.id = object.has("variant_id") ? object.at("variant_id").text()
                                        : id_of_spelled_out(object.required("variant"), backend);
    const JsonValue tunables = object.required("tunables");
    std::vector<std::string> names;
    if (!tunables.json().is_object()) {
        tunables.fail("an object: tunable -> value");
    }
    for (const auto& [name, number] : tunables.json().items()) {
        names.push_back(name);
    }
    const JsonObject values(tunables, names);
    for (const std::string& name : names) {
        entry.values[name] = whole(values.at(name));
        const std::vector<Tunable> all = all_tunables(backend);
        const auto named = std::find_if(all.begin(), all.end(), [&](const Tunable& t) { return t.name == name; });
        if (named != all.end() && named->sets_work) {
            values.at(name).fail("a tunable that sets how fast, not what is computed");
        }
        check_tunable(name, entry.values[name], tunables.file(), values.at(name).path());
    }
    entry.scene = object.required("scene").text();
    const std::vector<JsonValue> size = object.required("resolution").elements();
    if (size.size() != 2) {
        object.required("resolution").fail("[width, height]");
    }
    entry.width = whole(size[0]);
    entry.height = whole(size[1]);
    entry.depth = whole(object.required("depth"));
    entry.spp = whole(object.required("spp"));
    entry.standard_ms = object.required("standard_ms").number(0, 1e12, "milliseconds");
    entry.tuned_ms = object.required("tuned_ms").number(0, 1e12, "milliseconds");
    return entry;
}

}  // namespace

Tuning Tuning::load(const std::string& file, Backend backend) {
    Tuning tuning;
    tuning.backend_ = backend;
    if (!std::filesystem::exists(file)) {
        return tuning;
    }
    const Json json = parse_json(read_text_file(file), file);
    const JsonObject root(JsonValue(json, file, "$"), {"machine", "entries"});
    for (const JsonValue& entry : root.required("entries").elements()) {
        tuning.put(read_entry(entry, backend));
    }
    return tuning;
}

void Tuning::put(const TunedVariant& tuned) {
    const auto known =
        std::find_if(entries_.begin(), entries_.end(), [&](const TunedVariant& entry) { return entry.id == tuned.id; });
    if (known != entries_.end()) {
        *known = tuned;
    } else {
        entries_.push_back(tuned);
    }
}

void Tuning::save(const std::string& file, const std::string& machine) const {
    nlohmann::ordered_json json{{"machine", machine}, {"entries", nlohmann::ordered_json::array()}};
    for (const TunedVariant& entry : entries_) {
        json["entries"].push_back({{"variant", entry.variant},
                                   {"variant_id", entry.id},
                                   {"tunables", entry.values},
                                   {"scene", entry.scene},
                                   {"resolution", {entry.width, entry.height}},
                                   {"depth", entry.depth},
                                   {"spp", entry.spp},
                                   {"standard_ms", entry.standard_ms},
                                   {"tuned_ms", entry.tuned_ms}});
    }
    write_file(file, json.dump(1) + "\n");
}

const TunedVariant* Tuning::find(const std::string& id) const {
    for (const TunedVariant& entry : entries_) {
        if (entry.id == id) {
            return &entry;
        }
    }
    return nullptr;
}

Variant Tuning::applied(const Variant& variant, const std::set<std::string>& named) const {
    Variant plain = variant;
    plain.tuning.clear();
    const TunedVariant* const tuned = find(variant_id(plain, backend_));
    Variant result = variant;
    if (tuned != nullptr) {
        for (const auto& [name, value] : tuned->values) {
            if (!named.contains(name)) {
                result.tuning.try_emplace(name, value);
            }
        }
    }
    return result;
}

std::string tuning_file(Backend backend) {
    const std::string machine = backend == Backend::cuda ? cuda::machine_name() : machine_name();
    return (home_folder() / "results" / machine / "tuning.json").string();
}

std::vector<std::uint32_t> candidates(const Tunable& tunable) {
    if (tunable.sets_work) {
        return {};
    }
    std::set<std::uint32_t> values{tunable.default_value};
    const auto offer = [&](std::uint64_t value) {
        if (value <= tunable.highest && tunable.allows(static_cast<std::uint32_t>(value))) {
            values.insert(static_cast<std::uint32_t>(value));
        }
    };
    const std::uint32_t range = tunable.highest - tunable.lowest;
    if (tunable.highest <= 64) {
        // A tunable with a short range is tried in at most eight even steps.
        const std::uint32_t steps = std::min<std::uint32_t>(8, range);
        for (std::uint32_t step = 0; step <= steps; ++step) {
            offer(tunable.lowest + std::uint64_t{range} * step / std::max(1u, steps));
        }
    } else {
        // A long range is tried at the tunable's standard x 1/16 .. 16 or, if that is 0, at its limit x 1/16 .. 1.
        for (std::uint64_t factor = 1; factor <= 16; factor *= 2) {
            if (tunable.default_value == 0) {
                offer(tunable.highest / factor);
            }
            offer(tunable.default_value * factor);
            offer(tunable.default_value / factor);
        }
    }
    return {values.begin(), values.end()};
}

}  // namespace pt
