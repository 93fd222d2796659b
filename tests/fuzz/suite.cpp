// Suite files: parsed against the choices and tunables that this program has.
#include "harness/bench/suite.h"

#include "tests/fuzz/findings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::accept_or_refuse([&] {
        const pt::Suite suite = pt::parse_suite(pt::fuzz::text_of(data, size), "suite.json");
        pt::fuzz::require(!suite.studies.empty() && suite.repetitions > 0, "a suite that would run nothing");
    });
    return 0;
}
