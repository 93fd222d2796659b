# variants/ has one file per choice, found by its location. A .cpp registers itself; integrators and layouts are
# headers, because an integrator is compiled for every feature set and a layout is a type that several choices use.
file(GLOB variant_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*.cpp ${PROJECT_SOURCE_DIR}/variants/*/*.cpp)
file(GLOB integrator_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/integrator/*.h)
file(GLOB layout_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/layout/*.h)
file(GLOB axis_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*/axis.h)
list(REMOVE_ITEM integrator_headers ${axis_headers})
list(REMOVE_ITEM layout_headers ${axis_headers})
set(feature_set_file ${PROJECT_SOURCE_DIR}/variants/specialisation/cpu_feature_sets.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${feature_set_file})
set(generated ${PROJECT_BINARY_DIR}/generated)

# Writes axis_list.h, which lists the axes of the given headers axis.h, in the order that each header asks for.
function(ptbench_write_axis_list output) # further arguments: the headers
  set(includes "")
  set(axes_by_order "")
  foreach(header ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
    get_filename_component(axis ${header} DIRECTORY)
    get_filename_component(axis ${axis} NAME)
    file(STRINGS ${header} order REGEX "^    \\.order = [0-9]+,$")
    string(REGEX REPLACE "[^0-9]" "" order "${order}")
    if(order STREQUAL "")
      message(FATAL_ERROR "${header}: found no line \"    .order = NUMBER,\"")
    endif()
    string(APPEND includes "#include \"variants/${axis}/axis.h\"\n")
    list(APPEND axes_by_order "${order} ${axis}")
  endforeach()
  list(SORT axes_by_order COMPARE NATURAL)
  list(TRANSFORM axes_by_order REPLACE "^[0-9]+ (.+)$" " AXIS(\\1)")
  list(JOIN axes_by_order "" axes)
  file(CONFIGURE OUTPUT ${output} CONTENT "#pragma once\n${includes}#define PT_AXES(AXIS)${axes}\n")
endfunction()
ptbench_write_axis_list(${generated}/axis_list.h ${axis_headers})

# accelerator_list.h: every accelerator whose traversal kernels compile in, by the name of its file.
file(GLOB accelerator_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/accelerator/*.h)
set(accelerator_includes "")
set(accelerators "")
foreach(header ${accelerator_headers})
  file(STRINGS ${header} traversal REGEX "^(struct|using) Traversal" LIMIT_COUNT 1)
  if(traversal)
    get_filename_component(name ${header} NAME_WE)
    string(APPEND accelerator_includes "#include \"variants/accelerator/${name}.h\"\n")
    string(APPEND accelerators " ACCELERATOR(${name})")
    list(APPEND traversal_headers ${header})
  endif()
endforeach()
ptbench_write_host_units(accelerator_units ${traversal_headers})
file(CONFIGURE OUTPUT ${generated}/accelerator_list.h CONTENT
"#pragma once\n${accelerator_includes}#define PT_ACCELERATORS(ACCELERATOR)${accelerators}\n")

# Writes layouts.h and device_layouts.h, which list every path layout by the name of its file.
set(layout_includes "")
set(device_layout_includes "")
set(device_layouts "")
set(layout_types "")
set(layout_registrations "")
foreach(header ${layout_headers})
  get_filename_component(name ${header} NAME_WE)
  string(APPEND layout_includes "#include \"variants/layout/${name}.h\"\n")
  list(APPEND layout_types "layout::${name}::Paths<float>")
  string(APPEND layout_registrations
         "const Registration ${name}(layout::${name}::descriptor, {.layout = [] { return AnyPaths(layout::${name}::Paths<float>()); }});\n")
endforeach()
list(JOIN layout_types ", " layout_types)
foreach(header ${choices_with_kernels})
  if(header MATCHES "/layout/([a-z0-9_]+)\\.cuh$")
    string(APPEND device_layout_includes "#include \"variants/layout/${CMAKE_MATCH_1}.cuh\"\n")
    string(APPEND device_layouts " LAYOUT(${CMAKE_MATCH_1})")
  endif()
endforeach()
file(CONFIGURE OUTPUT ${generated}/layouts.h CONTENT
"#pragma once\n#include <variant>\n${layout_includes}namespace pt {\nusing AnyPaths = std::variant<${layout_types}>;\n}\n")
file(CONFIGURE OUTPUT ${generated}/device_layouts.h CONTENT
"#pragma once\n${device_layout_includes}#define PT_DEVICE_LAYOUTS(LAYOUT)${device_layouts}\n")
file(CONFIGURE OUTPUT ${generated}/layouts.cpp CONTENT
"#include \"variants/registry.h\"\nnamespace pt { namespace {\n${layout_registrations}} }\n")

# Each integrator is one translation unit per feature set; the generic kernel with all features is compiled once with
# pcg4d as the only sampler, and once with every sampler and guided walks.
option(PTBENCH_CPU_FEATURE_SETS "Compile the CPU integrators for the sets of cpu_feature_sets.txt too (off: the generic kernels alone)" ON)
set(feature_sets "all_features" "all_features | Feature::matrix" "all_features | samplings"
    "all_features | samplings | traversals" "all_features | samplings | traversals | path_trees"
    "all_features | samplings | path_trees")
set(lines "")
if(PTBENCH_CPU_FEATURE_SETS)
  file(STRINGS ${feature_set_file} lines)
endif()
foreach(line ${lines})
  string(STRIP "${line}" line)
  if(line MATCHES "^#" OR line STREQUAL "")
    continue()
  endif()
  string(REGEX REPLACE " +" " | Feature::" expression "${line}")
  list(APPEND feature_sets "no_features | Feature::${expression}")
endforeach()
set(integrator_sources ${generated}/layouts.cpp)
# Feature sets of kernels with other intersection formulas, by precision (kernels/config.h: formulas).
set(formula_sets_float "all_features | Feature::naive" "all_features | Feature::double_intersection")
set(formula_sets_double "all_features | Feature::naive")
function(add_integrator_unit unit name features real)
  file(CONFIGURE OUTPUT ${generated}/${unit}.cpp CONTENT
"#include \"variants/integrator/${name}.h\"
namespace pt { namespace {
constexpr FeatureSet features = ${features};
const IntegratorRegistration registration(integrator::${name}::descriptor, features,
                                          &integrator::${name}::render<Config<${real}, features, RunTimeAccelerator>>);
} }
")
  # The SLP vectoriser of g++ 12 at -O2 drops the rounding of a vector that is converted from double to float and back.
  if(features MATCHES "double_intersection")
    set_source_files_properties(${generated}/${unit}.cpp PROPERTIES COMPILE_OPTIONS
                                "$<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>")
  endif()
  set(integrator_sources ${integrator_sources} ${generated}/${unit}.cpp PARENT_SCOPE)
endfunction()
foreach(header ${integrator_headers})
  get_filename_component(name ${header} NAME_WE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  file(STRINGS ${header} sets REGEX "^    \\.[a-z_]+ = true,$") # its KernelSets (variants/integrator/axis.h)
  string(REGEX REPLACE "[^a-z_;]|true" "" sets "${sets}")
  set(index 0)
  foreach(features ${feature_sets})
    if("generic_alone" IN_LIST sets AND NOT features MATCHES "^all_features")
      continue()
    endif()
    if(features MATCHES "path_trees" AND NOT "with_path_trees" IN_LIST sets)
      continue()
    endif()
    add_integrator_unit(integrator_${name}_${index} ${name} "${features}" float)
    if("in_double" IN_LIST sets AND features MATCHES "^all_features" AND NOT features MATCHES "matrix")
      add_integrator_unit(integrator_${name}_double_${index} ${name} "${features}" double)
    endif()
    math(EXPR index "${index} + 1")
  endforeach()
  if("in_double" IN_LIST sets)
    foreach(real float double)
      foreach(features ${formula_sets_${real}})
        add_integrator_unit(integrator_${name}_${real}_${index} ${name} "${features}" ${real})
        math(EXPR index "${index} + 1")
      endforeach()
    endforeach()
  endif()
endforeach()

list(FILTER variant_sources EXCLUDE REGEX "/variants/cuda/|\\.cuda\\.cpp$")
if(PTBENCH_CUDA)
  list(APPEND integrator_sources ${cuda_sources})
endif()

# Writes choices_not_built.h with the choices that need CUDA or Embree where this build lacks these, so that suites may
# name them.
set(choices_not_built "")
if(NOT PTBENCH_EMBREE_INCLUDE OR NOT PTBENCH_EMBREE_LIBRARY)
  list(FILTER variant_sources EXCLUDE REGEX "/variants/(accelerator|builder)/embree[^/]*$")
  string(APPEND choices_not_built "    {\"accelerator\", \"embree\"},\n    {\"accelerator\", \"embree_native\"},\n    {\"builder\", \"embree\"},\n")
endif()
if(NOT PTBENCH_CUDA)
  file(GLOB device_sides CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*/*.cu ${PROJECT_SOURCE_DIR}/variants/*/*.cuda.cpp)
  list(FILTER device_sides EXCLUDE REGEX "/variants/cuda/")
  foreach(source ${device_sides} ${choices_with_kernels})
    get_filename_component(name ${source} NAME_WE)
    get_filename_component(axis ${source} DIRECTORY)
    get_filename_component(axis ${axis} NAME)
    string(APPEND choices_not_built "    {\"${axis}\", \"${name}\"},\n")
  endforeach()
endif()
file(CONFIGURE OUTPUT ${generated}/choices_not_built.h CONTENT
"#pragma once
#include <string_view>
#include <utility>
#include <vector>
namespace pt {
// Axis and name of each choice that only a build with a CUDA toolkit, or with Embree, has; none in one with both.
inline const std::vector<std::pair<std::string_view, std::string_view>> choices_not_built{
${choices_not_built}};
}
")

# Choices form an object library: from an archive the linker would drop their registrations, which nothing refers to.
add_library(ptbench_variants OBJECT ${variant_sources} ${accelerator_units} ${integrator_sources})
target_link_libraries(ptbench_variants PUBLIC ptbench_options)
if(PTBENCH_EMBREE_INCLUDE AND PTBENCH_EMBREE_LIBRARY)
  target_include_directories(ptbench_variants SYSTEM PRIVATE ${PTBENCH_EMBREE_INCLUDE})
  target_link_libraries(ptbench_variants PUBLIC ${PTBENCH_EMBREE_LIBRARY})
endif()
ptbench_precompile_headers(ptbench_variants)
# Sources of choices are compiled in groups, as a registration spends most of its compile time on the registry's header.
# Each file has a namespace of its own. Files whose code renders on the CPU (integrators, compactions, sorts) are left
# single, so that their machine code depends on nothing else.
if(PTBENCH_GROUP_SOURCES)
  set_target_properties(ptbench_variants PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  set_source_files_properties(${accelerator_units} PROPERTIES UNITY_GROUP traversals)
  foreach(source ${variant_sources})
    get_filename_component(folder ${source} DIRECTORY)
    if(source MATCHES "/variants/(builder|bvh|accelerator|levels)/")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP accelerators)
    elseif(EXISTS ${folder}/axis.h AND (source MATCHES "/none\\.cpp$" OR NOT folder MATCHES "/(compaction|sorting)$"))
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP choices)
    endif()
  endforeach()
endif()
if(PTBENCH_CUDA)
  file(GLOB cuda_choices CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*/*.cuda.cpp)
  set_source_files_properties(${cuda_choices} ${host_units} PROPERTIES UNITY_GROUP cuda_choices)
  file(GLOB cuda_host_side CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/cuda/*.cpp ${PROJECT_SOURCE_DIR}/variants/cuda/runtime/*.cpp)
  set_source_files_properties(${cuda_host_side} PROPERTIES UNITY_GROUP cuda_host_side)
  target_link_libraries(ptbench_variants PUBLIC ptbench_cudart)
  target_include_directories(ptbench_variants SYSTEM PRIVATE ${PTBENCH_NVRTC_INCLUDE})
endif()
