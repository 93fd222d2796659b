# Libraries come from the distribution. `./run` installs them; without it, CMake says which one is missing.
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(benchmark REQUIRED)
find_package(glm REQUIRED)
if(NOT TARGET glm::glm)
  add_library(glm::glm INTERFACE IMPORTED)
  target_include_directories(glm::glm INTERFACE ${GLM_INCLUDE_DIRS})
endif()
find_path(PTBENCH_STB_INCLUDE stb/stb_image_write.h REQUIRED)
find_path(PTBENCH_TINYGLTF_INCLUDE tiny_gltf.h)
if(NOT PTBENCH_TINYGLTF_INCLUDE)
  message(STATUS "tinygltf: not found: no reader for .glb meshes (libtinygltf-dev)")
endif()

option(PTBENCH_EMBREE "Use Embree 3 where it is found (off in packages: its library would be most of their bytes)" ON)
if(PTBENCH_EMBREE)
  # By hand: Debian's package configuration asks for TBB's headers, which nothing here needs.
  find_path(PTBENCH_EMBREE_INCLUDE embree3/rtcore.h)
  find_library(PTBENCH_EMBREE_LIBRARY embree3)
  if(NOT PTBENCH_EMBREE_INCLUDE OR NOT PTBENCH_EMBREE_LIBRARY)
    message(STATUS "Embree 3: not found: no accelerators embree and embree_native (libembree-dev)")
  endif()
endif()

find_package(OpenEXR 3.1 QUIET CONFIG)
if(NOT OpenEXR_FOUND)
  message(STATUS "OpenEXR 3: not found: no .exr images (libopenexr-dev)")
endif()

# Thrust: the CUDA toolkit's where there is one, the distribution's (libthrust-dev) where not.
find_program(PTBENCH_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin /usr/local/cuda/bin)
if(PTBENCH_NVCC)
  get_filename_component(PTBENCH_NVCC_REAL ${PTBENCH_NVCC} REALPATH)
  get_filename_component(PTBENCH_CUDA_BIN ${PTBENCH_NVCC_REAL} DIRECTORY)
  get_filename_component(PTBENCH_CUDA_ROOT ${PTBENCH_CUDA_BIN} DIRECTORY)
  message(STATUS "nvcc: ${PTBENCH_NVCC}")
else()
  message(STATUS "nvcc: not found: CPU backend only")
endif()
find_path(PTBENCH_THRUST_INCLUDE thrust/version.h
          PATHS ${PTBENCH_CUDA_ROOT}/include/cccl ${PTBENCH_CUDA_ROOT}/targets/x86_64-linux/include/cccl
                ${PTBENCH_CUDA_ROOT}/include
          NO_DEFAULT_PATH)
if(NOT PTBENCH_THRUST_INCLUDE)
  find_path(PTBENCH_THRUST_INCLUDE thrust/version.h REQUIRED)
endif()
message(STATUS "Thrust: ${PTBENCH_THRUST_INCLUDE}")
add_library(ptbench_thrust INTERFACE)
target_include_directories(ptbench_thrust SYSTEM INTERFACE ${PTBENCH_THRUST_INCLUDE})
target_compile_definitions(ptbench_thrust INTERFACE THRUST_HOST_SYSTEM=THRUST_HOST_SYSTEM_CPP
                                                    THRUST_DEVICE_SYSTEM=THRUST_DEVICE_SYSTEM_OMP)
