file(GLOB_RECURSE harness_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/*.cpp)
list(FILTER harness_sources EXCLUDE REGEX "/harness/main\\.cpp$")
add_library(ptbench_harness OBJECT ${harness_sources})
target_link_libraries(ptbench_harness PUBLIC ptbench_options nlohmann_json::nlohmann_json CLI11::CLI11 benchmark::benchmark)
target_include_directories(ptbench_harness SYSTEM PRIVATE ${PTBENCH_STB_INCLUDE})

add_executable(ptbench harness/main.cpp)
target_link_libraries(ptbench PRIVATE ptbench_harness ptbench_variants)
set_target_properties(ptbench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
