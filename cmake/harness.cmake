file(GLOB_RECURSE harness_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/*.cpp)
list(FILTER harness_sources EXCLUDE REGEX "/harness/(main\\.cpp$|cuda/)")
if(PTBENCH_CUDA)
  file(GLOB cuda_harness_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/cuda/*.cpp)
  list(FILTER cuda_harness_sources EXCLUDE REGEX "/without_cuda\\.cpp$")
  list(APPEND harness_sources ${cuda_harness_sources})
else()
  list(APPEND harness_sources ${PROJECT_SOURCE_DIR}/harness/cuda/without_cuda.cpp)
endif()
add_library(ptbench_harness OBJECT ${harness_sources})
# As the double_intersection kernels in variants.cmake.
set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/stability/replay.cpp PROPERTIES COMPILE_OPTIONS
                            "$<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>")
target_link_libraries(ptbench_harness PUBLIC ptbench_options nlohmann_json::nlohmann_json CLI11::CLI11 benchmark::benchmark)
target_include_directories(ptbench_harness SYSTEM PRIVATE ${PTBENCH_STB_INCLUDE})
set(PTBENCH_HARNESS_OPTIMISATION "" CACHE STRING "Optimisation of harness/, which traces no paths (empty: the build type's)")
target_compile_options(ptbench_harness PRIVATE ${PTBENCH_HARNESS_OPTIMISATION})
ptbench_precompile_headers(ptbench_harness)
# What a command costs to compile is CLI11: seven together cost what two cost alone.
set_target_properties(ptbench_harness PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
file(GLOB command_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/cli/*.cpp)
list(LENGTH command_sources commands)
math(EXPR half_of_the_commands "(${commands} + 1) / 2")
list(SUBLIST command_sources 0 ${half_of_the_commands} first_commands)
list(SUBLIST command_sources ${half_of_the_commands} -1 other_commands)
set_source_files_properties(${first_commands} PROPERTIES UNITY_GROUP commands_1)
set_source_files_properties(${other_commands} PROPERTIES UNITY_GROUP commands_2)
if(PTBENCH_CUDA)
  target_link_libraries(ptbench_harness PUBLIC ptbench_cudart)
  target_compile_definitions(ptbench_harness PRIVATE PTBENCH_CCCL_VERSION="${PTBENCH_CCCL_VERSION}")
endif()

list(JOIN PTBENCH_ROUNDING_OPTIONS " " recorded_flags)
string(STRIP "${PTBENCH_FLAGS} ${recorded_flags}" recorded_flags)
add_custom_target(ptbench_build_info BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/build_info.h
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DOUTPUT=${PROJECT_BINARY_DIR}/generated/build_info.h
          -DVERSION=${PROJECT_VERSION} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          "-DFLAGS=${recorded_flags}"
          -DBENCHMARK_VERSION=${benchmark_VERSION} -P ${PROJECT_SOURCE_DIR}/cmake/build_info.cmake
  VERBATIM)
add_dependencies(ptbench_harness ptbench_build_info)

add_executable(ptbench harness/main.cpp)
target_link_libraries(ptbench PRIVATE ptbench_harness ptbench_variants $<TARGET_NAME_IF_EXISTS:ptbench_nvcc>)
set_target_properties(ptbench PROPERTIES LINKER_LANGUAGE CXX)
set_target_properties(ptbench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
