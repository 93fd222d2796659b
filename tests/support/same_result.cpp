#include "tests/support/same_result.h"

namespace pt::test {

namespace {

using nlohmann::json;

void hide(json& object, const char* key) {
    if (object.contains(key)) {
        object[key] = std::string("a ") + object[key].type_name();
    }
}

void hide_in_row(json& row) {
    // Beside other jobs a clock may be unknown in one run and not in the other.
    for (const char* key : {"pt_clock_unknown", "pt_clock_mhz_before", "pt_clock_mhz_after"}) {
        row.erase(key);
    }
    for (const char* key :
         {"real_time", "cpu_time", "pt_wall_ms", "pt_device_ms", "pt_end_to_end_ms", "pt_rays_per_second",
          "pt_low_clock", "pt_foreign_cpu_ms", "pt_throttled_ms", "pt_throttled_periods", "pt_contended",
          "pt_involuntary_switches", "pt_order", "pt_timestamp"}) {
        hide(row, key);
    }
    if (row.contains("pt_checkpoints")) {
        for (json& checkpoint : row.at("pt_checkpoints")) {
            for (const char* key : {"wall_ms", "device_ms", "cpu_ms"}) {
                hide(checkpoint, key);
            }
        }
    }
}

void hide_in_cell(json& cell) {
    if (cell.contains("cuda")) {
        hide(cell.at("cuda"), "prepare_ms");
    }
    if (!cell.contains("instrumented")) {
        return;
    }
    json& pass = cell.at("instrumented");
    for (json& stage : pass.at("stage_ms")) {
        stage = "a time";
    }
    for (const char* key : {"wall_ms", "unaccounted_ms", "stages_add_up"}) {
        hide(pass, key);
    }
}

}  // namespace

json without_times(json result) {
    // What is compared stays, and which times say what of it goes.
    if (result.at("ptbench").contains("comparisons")) {
        for (json& comparison : result.at("ptbench").at("comparisons")) {
            for (const char* key : {"ratio", "interval", "word", "reason_code", "in_time", "in_cycles"}) {
                comparison.at(key) = "by times";
            }
        }
    }
    for (const char* key : {"date", "load_avg", "mhz_per_cpu", "ptbench.command_line"}) {
        hide(result.at("context"), key);
    }
    for (json& row : result.at("benchmarks")) {
        hide_in_row(row);
    }
    for (json& cell : result.at("ptbench").at("cells")) {
        hide_in_cell(cell);
    }
    hide(result.at("ptbench").at("run"), "sessions");
    result.at("ptbench").erase("retakes");  // of what disturbed the one and not the other
    return result;
}

}  // namespace pt::test
