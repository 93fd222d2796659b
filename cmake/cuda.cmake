# The CUDA backend, built where a toolkit is found: the static runtime (which loads the driver at its first call, so
# that the program starts without), NVRTC by dlopen, the sources for NVRTC, and the choices that nvcc compiles.
set(PTBENCH_CUDA OFF)
option(PTBENCH_WITH_CUDA "Build the CUDA backend where a toolkit is found" ON)
set(PTBENCH_CUDA_ARCHITECTURES "90-real" CACHE STRING "GPUs that Thrust and CUB are compiled for (path kernels are compiled at run time)")
# The GPU architectures that ptbench supports, from Turing to Blackwell; compile_test compiles path kernels for each.
set(PTBENCH_SUPPORTED_ARCHITECTURES 75 80 86 89 90 100 120)
if(PTBENCH_NVCC AND PTBENCH_WITH_CUDA)
  find_library(PTBENCH_CUDART cudart_static HINTS ${PTBENCH_CUDA_ROOT}/lib64 ${PTBENCH_CUDA_ROOT}/targets/x86_64-linux/lib)
  find_path(PTBENCH_CUDA_INCLUDE cuda_runtime_api.h HINTS ${PTBENCH_CUDA_ROOT}/include ${PTBENCH_CUDA_ROOT}/targets/x86_64-linux/include)
  find_path(PTBENCH_NVRTC_INCLUDE nvrtc.h HINTS ${PTBENCH_CUDA_INCLUDE})
  find_path(PTBENCH_CCCL_INCLUDE cub/version.cuh HINTS ${PTBENCH_CUDA_INCLUDE}/cccl ${PTBENCH_CUDA_INCLUDE} NO_DEFAULT_PATH)
  if(PTBENCH_CUDART AND PTBENCH_CUDA_INCLUDE AND PTBENCH_NVRTC_INCLUDE AND PTBENCH_CCCL_INCLUDE)
    set(PTBENCH_CUDA ON)
  endif()
endif()
message(STATUS "CUDA backend: ${PTBENCH_CUDA}")
# clang++ beside nvcc would fail only after minutes of building, so it is refused when configuring.
if(PTBENCH_CUDA AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  message(FATAL_ERROR "The compiler is ${CMAKE_CXX_COMPILER_ID} (${CMAKE_CXX_COMPILER}); beside nvcc, allowed: g++ "
                      "(unset CXX), or -DPTBENCH_WITH_CUDA=OFF for the CPU backend alone")
endif()
# Choices of variants whose kernels NVRTC compiles; a build without a toolkit needs only their names.
file(GLOB choices_with_kernels CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*/*.cuh)
foreach(header ${choices_with_kernels})
  file(STRINGS ${header} host_part REGEX "^#if defined\\(PT_HOST\\)" LIMIT_COUNT 1)
  if(NOT host_part)
    list(REMOVE_ITEM choices_with_kernels ${header})
  endif()
endforeach()
if(NOT PTBENCH_CUDA)
  return()
endif()

find_package(Threads REQUIRED)
add_library(ptbench_cudart INTERFACE)
target_include_directories(ptbench_cudart SYSTEM INTERFACE ${PTBENCH_CUDA_INCLUDE})
target_link_libraries(ptbench_cudart INTERFACE ${PTBENCH_CUDART} Threads::Threads ${CMAKE_DL_LIBS} rt)

file(STRINGS ${PTBENCH_CCCL_INCLUDE}/cub/version.cuh cub_version REGEX "#[ ]*define CUB_VERSION [0-9]+")
string(REGEX REPLACE ".*CUB_VERSION ([0-9]+).*" "\\1" cub_version "${cub_version}")
math(EXPR cub_major "${cub_version} / 100000")
math(EXPR cub_minor "${cub_version} / 100 % 1000")
math(EXPR cub_patch "${cub_version} % 100")
set(PTBENCH_CCCL_VERSION "${cub_major}.${cub_minor}.${cub_patch}")

# What NVRTC compiles: kernels/, the device side of choices, what both sides include, and the GLM headers behind
# glm/vec3.hpp.
file(GLOB embedded_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/kernels/*.h ${PROJECT_SOURCE_DIR}/kernels/*/*.h ${PROJECT_SOURCE_DIR}/variants/*/*.cuh
     ${PROJECT_SOURCE_DIR}/variants/accelerator/*.h ${PROJECT_SOURCE_DIR}/variants/bvh/*.h ${PROJECT_SOURCE_DIR}/variants/cuda/device/*)
# Headers that no NVRTC kernel includes are excluded, so that changing them does not invalidate the kernel cache.
list(FILTER embedded_headers EXCLUDE REGEX "/layout/payload_iterator\\.cuh$|/axis\\.h$")
get_target_property(glm_include glm::glm INTERFACE_INCLUDE_DIRECTORIES)
list(GET glm_include 0 glm_include)
file(GLOB glm_headers ${glm_include}/glm/vec3.hpp ${glm_include}/glm/ext/vector_bool3*.hpp ${glm_include}/glm/ext/vector_float3*.hpp
     ${glm_include}/glm/ext/vector_double3*.hpp ${glm_include}/glm/ext/vector_int3*.hpp ${glm_include}/glm/ext/vector_uint3*.hpp
     ${glm_include}/glm/ext/scalar_*int_sized.hpp ${glm_include}/glm/detail/*.hpp ${glm_include}/glm/detail/*.inl
     ${glm_include}/glm/detail/*.h ${glm_include}/glm/simd/*.h)
set(embedded "")
foreach(header ${embedded_headers})
  file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${header})
  list(APPEND embedded "${name}=${header}")
endforeach()
foreach(header ${glm_headers})
  file(RELATIVE_PATH name ${glm_include} ${header})
  list(APPEND embedded "${name}=${header}")
endforeach()
set(embedded_file ${PROJECT_BINARY_DIR}/generated/embedded_sources.cpp)
add_custom_command(OUTPUT ${embedded_file}
  COMMAND ${CMAKE_COMMAND} "-DFILES=${embedded}" -DOUTPUT=${embedded_file} -P ${PROJECT_SOURCE_DIR}/cmake/embed_sources.cmake
  DEPENDS ${embedded_headers} ${PROJECT_SOURCE_DIR}/cmake/embed_sources.cmake VERBATIM)
set(cuda_sources ${embedded_file})

# NAME.cuda.cpp registers a choice on CUDA that has no kernels.
file(GLOB cuda_host_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/cuda/*.cpp ${PROJECT_SOURCE_DIR}/variants/cuda/runtime/*.cpp
     ${PROJECT_SOURCE_DIR}/variants/*/*.cuda.cpp)
ptbench_write_host_units(host_units ${choices_with_kernels})
list(APPEND cuda_host_sources ${host_units})
list(APPEND cuda_sources ${cuda_host_sources})

# nvcc compiles .cu sources: choices that use Thrust or CUB, queue kernels, the harness's clock, ceilings and rays.
set(CMAKE_CUDA_COMPILER ${PTBENCH_NVCC})
set(CMAKE_CUDA_ARCHITECTURES ${PTBENCH_CUDA_ARCHITECTURES})
set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
enable_language(CUDA)
# CMake before 3.26 does not know nvcc's option for C++20.
set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
set(CMAKE_CUDA_FLAGS_RELEASE "-O3 -DNDEBUG")
file(GLOB nvcc_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/variants/*/*.cu ${PROJECT_SOURCE_DIR}/harness/cuda/*.cu
     ${PROJECT_SOURCE_DIR}/harness/rays/*.cu)
# Without fused multiply-adds GPU hits are bitwise equal to the host's.
set_source_files_properties(${PROJECT_SOURCE_DIR}/harness/rays/gpu_batch.cu PROPERTIES COMPILE_OPTIONS --fmad=false)
# Sources that use Thrust are compiled as one unit, and those that use CUB as another, so that each library is parsed
# and instantiated once (results/build_times.md). Each file has a namespace of its own.
function(group_nvcc_sources library files)
  list(FILTER nvcc_sources INCLUDE REGEX "${files}")
  list(TRANSFORM nvcc_sources REPLACE "(.+)" "#include \"\\1\"\n" OUTPUT_VARIABLE includes)
  list(JOIN includes "" includes)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${library}_choices.cu CONTENT "${includes}" @ONLY)
endfunction()
if(PTBENCH_GROUP_SOURCES)
  set(uses_thrust "/variants/.*/thrust_[a-z_]+\\.cu$")
  set(uses_cub "/variants/(.*/cub_[a-z_]+|cuda/radix_sort|builder/hploc)\\.cu$")
  group_nvcc_sources(thrust "${uses_thrust}")
  group_nvcc_sources(cub "${uses_cub}")
  list(FILTER nvcc_sources EXCLUDE REGEX "${uses_thrust}|${uses_cub}")
  list(APPEND nvcc_sources ${PROJECT_BINARY_DIR}/generated/thrust_choices.cu ${PROJECT_BINARY_DIR}/generated/cub_choices.cu)
endif()
add_library(ptbench_nvcc_options INTERFACE)
target_include_directories(ptbench_nvcc_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
target_include_directories(ptbench_nvcc_options SYSTEM INTERFACE ${glm_include})
target_compile_options(ptbench_nvcc_options INTERFACE -include=cuda.h --expt-relaxed-constexpr --extended-lambda -diag-suppress=20012
                       -Xcompiler=-Wall,-Wextra,-Wno-unused-parameter,-Wno-unknown-pragmas)
target_compile_definitions(ptbench_nvcc_options INTERFACE GLM_FORCE_CUDA)
add_library(ptbench_nvcc OBJECT ${nvcc_sources})
target_link_libraries(ptbench_nvcc PRIVATE ptbench_nvcc_options)

# Compiles the nvcc units for other GPUs than the build's own, without linking, to find errors before a user does. The
# tests' build does so for the oldest and the newest GPU (`nvcc_oldest_and_newest`), `./run architectures` for all
# (`nvcc_everywhere`).
set(oldest_and_newest 75 120)
set(everywhere ${PTBENCH_SUPPORTED_ARCHITECTURES})
foreach(which oldest_and_newest everywhere)
  list(TRANSFORM ${which} APPEND -real)
  add_custom_target(nvcc_${which})
endforeach()
function(ptbench_compile_elsewhere target) # further arguments: the libraries that it links
  get_target_property(sources ${target} SOURCES)
  foreach(which oldest_and_newest everywhere)
    add_library(${target}_${which} OBJECT EXCLUDE_FROM_ALL ${sources})
    target_link_libraries(${target}_${which} PRIVATE ${ARGN})
    target_compile_options(${target}_${which} PRIVATE -fatbin)
    set_target_properties(${target}_${which} PROPERTIES CUDA_ARCHITECTURES "${${which}}")
    add_dependencies(nvcc_${which} ${target}_${which})
  endforeach()
endfunction()
ptbench_compile_elsewhere(ptbench_nvcc ptbench_nvcc_options)
