# Writes build_info.h, which records what the binary was built from, at every build, but only if it has changed.
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse HEAD OUTPUT_VARIABLE sha OUTPUT_STRIP_TRAILING_WHITESPACE
                RESULT_VARIABLE failed ERROR_QUIET)
if(failed)
  set(sha "unknown")
  set(dirty 1)
else()
  # Results and figures are outputs, so changes to them do not make the sources dirty.
  execute_process(COMMAND git -C ${SOURCE_DIR} status --porcelain -- kernels variants harness stability scenes cmake CMakeLists.txt
                  OUTPUT_VARIABLE changes)
  if(changes)
    set(dirty 1)
  else()
    set(dirty 0)
  endif()
endif()
# A hash of the sources that an image depends on, by which cached reference images are invalidated.
file(GLOB_RECURSE image_sources ${SOURCE_DIR}/kernels/*.h ${SOURCE_DIR}/variants/integrator/* ${SOURCE_DIR}/variants/sampler/*
     ${SOURCE_DIR}/harness/scene/* ${SOURCE_DIR}/harness/mesh/*)
list(SORT image_sources)
set(image_hashes "")
foreach(source ${image_sources})
  file(MD5 ${source} hash)
  string(APPEND image_hashes ${hash})
endforeach()
string(MD5 image_hash "${image_hashes}")
string(SUBSTRING ${image_hash} 0 16 image_hash)
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT
"#pragma once
#define PTBENCH_GIT_SHA \"${sha}\"
#define PTBENCH_GIT_DIRTY ${dirty}
#define PTBENCH_IMAGE_SOURCES_HASH \"${image_hash}\"
#define PTBENCH_VERSION \"${VERSION}\"
#define PTBENCH_COMPILER \"${COMPILER}\"
#define PTBENCH_COMPILER_FLAGS \"${FLAGS}\"
#define PTBENCH_BUILD_TYPE \"${BUILD_TYPE}\"
#define PTBENCH_BENCHMARK_VERSION \"${BENCHMARK_VERSION}\"
")
