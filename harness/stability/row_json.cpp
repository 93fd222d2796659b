// Writes rows and cases of stability runs as JSON for the result file.
#include <cmath>
#include <iterator>

#include "harness/stability/evaluate.h"
#include "variants/variant_name.h"

namespace pt::stability {

namespace {

// Infinities and NaN, which JSON lacks, are written as strings.
Json number(double value) {
    if (std::isfinite(value)) {
        return value;
    }
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

std::string_view to_string(Relation relation) {
    return relation == Relation::equal ? "equal" : relation == Relation::at_most ? "at most" : "at least";
}

// The pixel, sample and segment at which a health counter first counted, for `ptbench replay`.
Json place_of(std::uint64_t key) {
    return {{"pixel", key >> 42}, {"sample", (key >> 20) & 0x3fffffu}, {"segment", key & 0xfffffu}};
}

Json to_json(const HealthCounters& health) {
    static constexpr const char* sites[] = {"camera", "hit", "point", "normal", "direction", "throughput", "radiance"};
    static_assert(std::size(sites) == health_sites);
    Json json{{"paths", health.paths}, {"segments", health.segments}};
    Json nonfinite = Json::object();
    Json first = Json::object();
    for (std::size_t site = 0; site < health_sites; ++site) {
        if (health.nonfinite[site] != 0) {
            nonfinite[sites[site]] = health.nonfinite[site];
            first[sites[site]] = place_of(health.first_nonfinite[site]);
        }
    }
    if (health.self_hits != 0) {
        first["self_hit"] = place_of(health.first_self_hit);
    }
    if (health.parity_errors != 0) {
        first["parity_error"] = place_of(health.first_parity_error);
    }
    json["nonfinite"] = std::move(nonfinite);
    json["negative"] = health.negative;
    json["energy_gains"] = health.gains;
    json["self_hits"] = health.self_hits;
    json["parity_errors"] = health.parity_errors;
    json["escaped"] = health.escaped;
    json["capped"] = health.capped;
    json["capped_energy"] = static_cast<double>(health.capped_energy) * 0x1p-32;
    json["unfinished_walks"] = health.unfinished_walks;
    json["worst_direction"] = static_cast<double>(health.worst_direction) * 0x1p-40;
    json["worst_normal"] = static_cast<double>(health.worst_normal) * 0x1p-40;
    json["first"] = std::move(first);
    return json;
}

}  // namespace

Json to_json(const Values& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values.all()) {
        json[name] = value;
    }
    return json;
}

Json to_json(const Task& task, const Row& row) {
    Json json{{"case", task.stiff_case->name}, {"point", to_json(task.values)}};
    json["backend"] = task.stiff_case->direct ? "host" : pt::to_string(task.backend);
    json["variant_id"] = variant_id(task.variant, task.backend);
    json["status"] = to_string(row.status);
    json["must_pass"] = must_pass(task.variant, task.backend);
    if (!row.reason.empty()) {
        json["reason"] = row.reason;
    }
    if (row.measurement.quantity.empty()) {
        return json;
    }
    const Measurement& m = row.measurement;
    json["quantity"] = m.quantity;
    json["relation"] = to_string(m.relation);
    json["measured"] = number(m.measured);
    json["exact"] = number(m.exact);
    json["error"] = number(row.error);
    json["allowed"] = number(row.allowed);
    json["tolerance"] = number(m.tolerance.at(traits_of(task.variant, task.backend).precision));
    json["tolerance_origin"] = m.tolerance.origin;
    json["standard_error"] = number(m.standard_error);
    json["looks"] = row.looks;
    json["paths"] = row.paths;
    json["rays"] = row.rays;
    json["unfinished_walks"] = row.unfinished_walks;
    json["nonfinite"] = row.faults.nonfinite;
    json["negative"] = row.faults.negative;
    json["saturated"] = row.faults.saturated;
    if (row.health.paths != 0) {
        json["health"] = to_json(row.health);
    }
    if (!row.film_hash.empty()) {
        json["film_hash"] = row.film_hash;
    }
    json["seconds"] = row.seconds;
    return json;
}

Json to_json(const Task& task, const std::vector<Row>& rows) {
    Json json = Json::array();
    for (const Row& row : rows) {
        json.push_back(to_json(task, row));
    }
    return json;
}

Json to_json(const Case& stiff_case) {
    Json json{{"name", stiff_case.name},   {"catalogue", stiff_case.catalogue}, {"family", stiff_case.family},
              {"title", stiff_case.title}, {"stiff", stiff_case.stiff},         {"formula", stiff_case.formula}};
    json["parameters"] = Json::array();
    for (const Parameter& parameter : stiff_case.parameters) {
        json["parameters"].push_back({{"name", parameter.name},
                                      {"standard", parameter.default_value},
                                      {"lowest", parameter.lowest},
                                      {"highest", parameter.highest},
                                      {"summary", parameter.summary}});
    }
    json["sweep"] = stiff_case.sweep;
    json["kind"] = !stiff_case.missing_feature.empty() ? "missing"
                   : stiff_case.renderings             ? "render"
                   : stiff_case.twins                  ? "identity"
                                                       : "direct";
    if (!stiff_case.missing_feature.empty()) {
        json["missing_feature"] = stiff_case.missing_feature;
    }
    return json;
}

}  // namespace pt::stability
