// Result files of two runs of one command, compared in all but what a clock, a process or the order of time gave.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pt::test {

// The result with "a number", "a string", .. in place of every value that another run of the same command has
// otherwise: times, clocks, load, dates, the order in which samples were taken, and what those decide. Every key stays,
// so that a comparison with == finds what is missing.
nlohmann::json without_times(nlohmann::json result);

}  // namespace pt::test
