# Precompiled headers of the standard library and packages that most of harness/, variants/ and tests/ includes, as
# parsing them takes half the time of a translation unit. Thrust's headers include the CUDA runtime's. ptbench's own
# headers are left out, so that a change to one rebuilds only its users. CLI11 is left out because its non-template code
# would be compiled in every file, 7 seconds each. nlohmann/json.hpp instantiates its parser in every file, half a
# second each, so only targets that ask for PTBENCH_PRECOMPILED_JSON get it.
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

# Reuses another target's precompiled headers, which requires exactly equal compile options.
function(ptbench_reuse_precompiled_headers target other)
  if(PTBENCH_PRECOMPILE_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()
