#include "harness/bench/benchmark_flags.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <regex>
#include <string_view>

#include "harness/failure.h"

namespace pt {

namespace {

struct BenchmarkFlag {
    std::string_view name;
    std::string_view values;   // regular expression for the flag's values; empty: ptbench refuses the flag
    std::string_view allowed;  // the flag's allowed values in words, for messages
    bool may_be_bare = false;  // whether the flag may be given without a value
};

constexpr std::string_view any_truth = "true|false|yes|no|on|off|1|0";
constexpr std::string_view any_format = "console|json|csv";
constexpr std::string_view any_seconds = "[0-9]+([.][0-9]*)?([eE][-+]?[0-9]+)?s?";

// The flags of Google Benchmark 1.7.1 and later, with the ptbench option that replaces a refused one.
constexpr std::array known_flags{
    BenchmarkFlag{"list_tests", "", "--dry-run, which lists the cells"},
    BenchmarkFlag{"dry_run", "", "--dry-run, which lists the cells"},
    BenchmarkFlag{"filter", ".*", "a regular expression"},
    BenchmarkFlag{"repetitions", "[0-9]+", "a whole number from 1"},
    BenchmarkFlag{"min_time", any_seconds, "seconds"},
    BenchmarkFlag{"min_warmup_time", "", "none: the first render of a cell warms it up, and is not timed"},
    BenchmarkFlag{"enable_random_interleaving", any_truth, "true or false", true},
    BenchmarkFlag{"report_aggregates_only", any_truth, "true or false", true},
    BenchmarkFlag{"display_aggregates_only", any_truth, "true or false", true},
    BenchmarkFlag{"format", any_format, "console, json or csv"},
    BenchmarkFlag{"out", ".+", "a file name"},
    BenchmarkFlag{"out_format", any_format, "console, json or csv"},
    BenchmarkFlag{"color", "auto|true|false|yes|no|on|off|1|0", "auto, true or false"},
    BenchmarkFlag{"counters_tabular", any_truth, "true or false", true},
    BenchmarkFlag{"perf_counters", ".*", "names of counters, with commas between them"},
    BenchmarkFlag{"context", "[^=,]+=[^=,]*(,[^=,]+=[^=,]*)*", "KEY=VALUE, with commas between several"},
    BenchmarkFlag{"time_unit", "ns|us|ms|s", "ns, us, ms or s"},
};

const BenchmarkFlag* flag_of(std::string_view name) {
    const auto found = std::find_if(known_flags.begin(), known_flags.end(),
                                    [&](const BenchmarkFlag& flag) { return flag.name == name; });
    return found == known_flags.end() ? nullptr : &*found;
}

}  // namespace

void check_benchmark_flags(const std::vector<std::string>& given) {
    constexpr std::string_view prefix = "--benchmark_";
    for (const std::string& argument : given) {
        const std::size_t equals = argument.find('=');
        const bool is_bare = equals == std::string::npos;
        const std::string name = argument.substr(0, equals);
        const BenchmarkFlag* const flag =
            name.starts_with(prefix) ? flag_of(std::string_view(name).substr(prefix.size())) : nullptr;
        if (flag == nullptr) {
            throw InputError("command line", "flag", "\"" + argument + "\"", "Google Benchmark's --benchmark_* flags");
        }
        if (flag->values.empty()) {
            throw InputError("command line", "flag", "\"" + argument + "\"", std::string(flag->allowed));
        }
        const std::string value = is_bare ? "" : argument.substr(equals + 1);
        const std::regex values(flag->values.begin(), flag->values.end());
        if (is_bare ? !flag->may_be_bare : !std::regex_match(value, values)) {
            throw InputError(name, "argument", is_bare ? "no value" : "\"" + value + "\"", std::string(flag->allowed));
        }
    }
}

std::vector<std::string> benchmark_variables() {
    std::vector<std::string> names;
    for (const BenchmarkFlag& flag : known_flags) {
        std::string name = "BENCHMARK_";
        std::transform(flag.name.begin(), flag.name.end(), std::back_inserter(name),
                       [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
        names.push_back(name);
    }
    return names;
}

}  // namespace pt
