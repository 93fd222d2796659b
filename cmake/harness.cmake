file(GLOB_RECURSE harness_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/*.cpp ${PROJECT_SOURCE_DIR}/stability/*.cpp)
list(FILTER harness_sources EXCLUDE REGEX "/harness/(cli/main\\.cpp$|cuda/)")
if(PTBENCH_CUDA)
  file(GLOB cuda_harness_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/cuda/*.cpp)
  list(FILTER cuda_harness_sources EXCLUDE REGEX "/without_cuda\\.cpp$")
  list(FILTER harness_sources EXCLUDE REGEX "/rays/gpu_batch_without_cuda\\.cpp$")
  list(APPEND harness_sources ${cuda_harness_sources})
else()
  list(APPEND harness_sources ${PROJECT_SOURCE_DIR}/harness/cuda/without_cuda.cpp)
endif()

# Groups the sources of a folder into unity builds, so that templates of their headers (JSON above all) are instantiated
# once: a group costs little more than one file. So a name in an anonymous namespace must be unique in its folder, and
# each file of stability/cases/ has a namespace of its own.
function(ptbench_group_sources target)
  if(NOT PTBENCH_GROUP_SOURCES)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  foreach(source ${sources})
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${source})
    get_filename_component(folder ${folder} DIRECTORY)
    string(MAKE_C_IDENTIFIER ${folder} folder)
    list(APPEND folders ${folder})
    list(APPEND sources_of_${folder} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  # In a unity build g++ takes the files for headers, and would warn about types of their anonymous namespaces.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  foreach(folder ${folders})
    # Unity groups of about equal size keep all cores busy to the end of the build.
    list(LENGTH sources_of_${folder} count)
    math(EXPR groups "(${count} + 9) / 10")
    set(index 0)
    foreach(source ${sources_of_${folder}})
      math(EXPR group "${index} * ${groups} / ${count}")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
      math(EXPR index "${index} + 1")
    endforeach()
  endforeach()
endfunction()

# Sources compiled at the build type's optimisation: those that run while a time is taken, and those that compute
# scenes, oracles and statistics. (The sine of a constant may be rounded by the compiler or by the C library, which
# differ in the last bit.) The rest of harness/ reads, writes, counts, or waits for a device, so that compile time
# matters more. In builds other than Release that includes what writes scenes, as their numbers are not published.
if(PTBENCH_MPI AND MPI_CXX_FOUND)
  list(FILTER harness_sources EXCLUDE REGEX "/ranks/without_mpi\\.cpp$")
else()
  list(FILTER harness_sources EXCLUDE REGEX "/ranks/mpi\\.cpp$")
endif()

set(rendering_rooms "/harness/(render|scene|mesh|rays|error|stability)/|/harness/(exr|machine/cpu_clock)\\.cpp$")
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  string(APPEND rendering_rooms "|/harness/interchange/|^${PROJECT_SOURCE_DIR}/stability/")
endif()
set(rendering_sources ${harness_sources})
list(FILTER rendering_sources INCLUDE REGEX "${rendering_rooms}")
list(REMOVE_ITEM harness_sources ${rendering_sources})
add_library(ptbench_rendering OBJECT ${rendering_sources})
add_library(ptbench_harness OBJECT ${harness_sources})
foreach(target ptbench_rendering ptbench_harness)
  target_link_libraries(${target} PUBLIC ptbench_options nlohmann_json::nlohmann_json CLI11::CLI11 benchmark::benchmark)
  target_include_directories(${target} SYSTEM PRIVATE ${PTBENCH_STB_INCLUDE})
  if(PTBENCH_CUDA)
    target_link_libraries(${target} PUBLIC ptbench_cudart)
  endif()
  ptbench_group_sources(${target})
  # Coverage instrumentation guides the fuzzer. (-fsanitize=fuzzer-no-link would keep ptbench_rendering from using the
  # kernels' precompiled headers, which no fuzzer follows.)
  if(PTBENCH_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,indirect-calls,trace-cmp,pc-table)
  endif()
endforeach()
list(JOIN PTBENCH_SUPPORTED_ARCHITECTURES "\", \"sm_" supported_architectures)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/supported_architectures.h CONTENT
"// The GPUs of cmake/cuda.cmake.
#pragma once
constexpr const char* supported_architectures[] = {\"sm_${supported_architectures}\"};
")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/cccl_version.h CONTENT
"#pragma once
#define PTBENCH_CCCL_VERSION \"${PTBENCH_CCCL_VERSION}\"
")
# replay.cpp is exempt from g++'s SLP vectoriser for the same reason as double_intersection kernels (variants.cmake).
set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/stability/replay.cpp PROPERTIES COMPILE_OPTIONS
                            "$<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>")
if(PTBENCH_MPI AND MPI_CXX_FOUND)
  target_link_libraries(ptbench_harness PUBLIC MPI::MPI_CXX)
  set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/ranks/mpi.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endif()
# tinygltf is compiled in gltf_model.cpp; only the files of glb_reader include it.
set(glb_reader ${PROJECT_SOURCE_DIR}/harness/mesh/gltf_model.cpp ${PROJECT_SOURCE_DIR}/harness/mesh/read_glb.cpp
    ${PROJECT_SOURCE_DIR}/harness/interchange/import_gltf.cpp ${PROJECT_SOURCE_DIR}/harness/interchange/import_gltf_image.cpp
    ${PROJECT_SOURCE_DIR}/harness/interchange/import_gltf_material.cpp)
set_source_files_properties(${glb_reader} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
if(PTBENCH_TINYGLTF_INCLUDE)
  set_source_files_properties(${glb_reader} PROPERTIES COMPILE_DEFINITIONS PTBENCH_HAS_TINYGLTF)
  foreach(target ptbench_rendering ptbench_harness)
    target_include_directories(${target} SYSTEM PRIVATE ${PTBENCH_TINYGLTF_INCLUDE})
  endforeach()
endif()
# OpenEXR's headers are used by exr.cpp only.
set(exr_writer ${PROJECT_SOURCE_DIR}/harness/exr.cpp)
if(OpenEXR_FOUND)
  set_source_files_properties(${exr_writer} PROPERTIES COMPILE_DEFINITIONS PTBENCH_HAS_OPENEXR
                              SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
  foreach(part OpenEXR::OpenEXR OpenEXR::OpenEXRConfig OpenEXR::Iex OpenEXR::IlmThread Imath::Imath Imath::ImathConfig)
    target_include_directories(ptbench_rendering SYSTEM PRIVATE $<TARGET_PROPERTY:${part},INTERFACE_INCLUDE_DIRECTORIES>)
  endforeach()
  # OpenEXR is linked without its compile options, which would keep other files from using the precompiled headers.
  target_link_libraries(ptbench_rendering INTERFACE $<LINK_ONLY:OpenEXR::OpenEXR>)
endif()
# pugixml is used by xml_document.cpp only.
set(xml_reader ${PROJECT_SOURCE_DIR}/harness/interchange/xml_document.cpp)
if(PTBENCH_PUGIXML_INCLUDE AND PTBENCH_PUGIXML_LIBRARY)
  set_source_files_properties(${xml_reader} PROPERTIES COMPILE_DEFINITIONS PTBENCH_HAS_PUGIXML SKIP_UNITY_BUILD_INCLUSION ON)
  foreach(target ptbench_rendering ptbench_harness)
    target_include_directories(${target} SYSTEM PRIVATE ${PTBENCH_PUGIXML_INCLUDE})
  endforeach()
  target_link_libraries(ptbench_rendering INTERFACE ${PTBENCH_PUGIXML_LIBRARY})
endif()
set(PTBENCH_HARNESS_OPTIMISATION "" CACHE STRING
    "Optimisation of the parts of harness/ that time and compute nothing (empty: -O1 in a release build, else the build type's)")
set(harness_optimisation "${PTBENCH_HARNESS_OPTIMISATION}")
if(harness_optimisation STREQUAL "" AND CMAKE_BUILD_TYPE STREQUAL "Release")
  set(harness_optimisation "-O1")
endif()
target_compile_options(ptbench_harness PRIVATE ${harness_optimisation})
# The glTF reader gives equal results at every optimisation level, so it is compiled at the harness's level.
set_property(SOURCE ${glb_reader} APPEND PROPERTY COMPILE_OPTIONS ${harness_optimisation})
# machine.cpp contains the commit and is not grouped, so that a new commit recompiles only this file.
set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/machine/machine.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
ptbench_precompile_headers(ptbench_harness ${PTBENCH_PRECOMPILED_JSON})
ptbench_reuse_precompiled_headers(ptbench_rendering ptbench_variants)
# All programs link the parts of ptbench in this order: where several parts contain a function, the linker takes
# the first copy, which must be the one compiled for the kernels.
set(PTBENCH_PARTS $<TARGET_NAME_IF_EXISTS:ptbench_nvcc> ptbench_variants ptbench_rendering ptbench_harness)

list(JOIN PTBENCH_ROUNDING_OPTIONS " " recorded_flags)
string(STRIP "${PTBENCH_FLAGS} ${recorded_flags}" recorded_flags)
add_custom_target(ptbench_build_info BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/build_info.h
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DOUTPUT=${PROJECT_BINARY_DIR}/generated/build_info.h
          -DVERSION=${PROJECT_VERSION} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          "-DFLAGS=${recorded_flags}"
          -DBENCHMARK_VERSION=${benchmark_VERSION} -P ${PROJECT_SOURCE_DIR}/cmake/build_info.cmake
  VERBATIM)
add_dependencies(ptbench_rendering ptbench_build_info)
add_dependencies(ptbench_harness ptbench_build_info)

add_executable(ptbench harness/cli/main.cpp)
target_link_libraries(ptbench PRIVATE ${PTBENCH_PARTS})
target_compile_options(ptbench PRIVATE ${harness_optimisation})
ptbench_reuse_precompiled_headers(ptbench ptbench_harness)
set_target_properties(ptbench PROPERTIES LINKER_LANGUAGE CXX)
set_target_properties(ptbench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})

# The program rays_cpu measures rates of ray batches on the CPU. No test runs it, but the tests' build keeps it valid.
add_executable(rays_cpu tools/rays/rays_cpu.cpp)
target_link_libraries(rays_cpu PRIVATE ${PTBENCH_PARTS})
if(PTBENCH_EMBREE_INCLUDE AND PTBENCH_EMBREE_LIBRARY)
  target_compile_definitions(rays_cpu PRIVATE PTBENCH_HAS_EMBREE)
  target_include_directories(rays_cpu SYSTEM PRIVATE ${PTBENCH_EMBREE_INCLUDE})
endif()
set_target_properties(rays_cpu PROPERTIES LINKER_LANGUAGE CXX)

# Target rays_optix measures rates of ray batches through OptiX alone, and is built only on request. It needs the
# headers of https://github.com/NVIDIA/optix-dev, whose folder -DPTBENCH_OPTIX_INCLUDE=DIR names.
find_path(PTBENCH_OPTIX_INCLUDE optix.h HINTS $ENV{OPTIX_ROOT}/include)
if(PTBENCH_CUDA AND PTBENCH_OPTIX_INCLUDE)
  set(optix_device ${PROJECT_BINARY_DIR}/rays_optix.optixir)
  add_custom_command(OUTPUT ${optix_device}
    COMMAND ${CMAKE_CUDA_COMPILER} -std=c++20 -optix-ir -diag-suppress 20012 -I${PROJECT_SOURCE_DIR} -I${PTBENCH_OPTIX_INCLUDE}
            ${PROJECT_SOURCE_DIR}/tools/rays/rays_optix_device.cu -o ${optix_device}
    DEPENDS tools/rays/rays_optix_device.cu tools/rays/rays_optix.h harness/rays/ray_batch.h VERBATIM)
  add_executable(rays_optix EXCLUDE_FROM_ALL tools/rays/rays_optix.cpp ${optix_device})
  target_compile_definitions(rays_optix PRIVATE PTBENCH_RAYS_OPTIX_DEVICE="${optix_device}")
  target_include_directories(rays_optix SYSTEM PRIVATE ${PTBENCH_OPTIX_INCLUDE})
  target_link_libraries(rays_optix PRIVATE ${PTBENCH_PARTS})
  set_target_properties(rays_optix PROPERTIES LINKER_LANGUAGE CXX)
elseif(PTBENCH_CUDA)
  message(STATUS "OptiX headers: not found, so there is no target rays_optix (-DPTBENCH_OPTIX_INCLUDE=DIR)")
endif()
