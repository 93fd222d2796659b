# The headers of the standard library and of the packages that most of harness/, variants/ and tests/ includes, parsed
# once: they are half of what a translation unit costs to compile. Thrust's bring those of the CUDA runtime. None of ours
# is here: a change to one rebuilds only what includes it. Nor is CLI11: what it defines beside templates is compiled
# anew in every file that has it, 7 seconds each. nlohmann/json.hpp instantiates its parser in every file that has it, half
# a second each: only targets that ask for PTBENCH_PRECOMPILED_JSON have it.
option(PTBENCH_PRECOMPILE_HEADERS "Parse the packages' headers once (off: shows an #include that is missing)" ON)
set(PTBENCH_PRECOMPILED_HEADERS <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <optional> <random> <set> <span> <sstream> <string> <variant> <vector> <fmt/format.h> <fmt/ranges.h> <glm/vec3.hpp>
    <thrust/detail/type_traits.h> <thrust/iterator/iterator_facade.h>)
set(PTBENCH_PRECOMPILED_JSON <nlohmann/json.hpp>)

function(ptbench_precompile_headers target)
  if(PTBENCH_PRECOMPILE_HEADERS)
    target_precompile_headers(${target} PRIVATE ${PTBENCH_PRECOMPILED_HEADERS} ${ARGN})
  endif()
endfunction()

# For targets with the very options of the other.
function(ptbench_reuse_precompiled_headers target other)
  if(PTBENCH_PRECOMPILE_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()
