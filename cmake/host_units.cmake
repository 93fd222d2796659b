# A choice with kernels of its own, or with a traversal that kernels compile in, is one header. Its last part, compiled
# only where PT_HOST is defined, is host code that launches the kernels and registers the choice. A generated source
# file compiles that part; NVRTC does not see it (cmake/embed_sources.cmake).
function(ptbench_write_host_unit output header) # `header`: path of a choice's file, absolute or from the repository's root
  file(CONFIGURE OUTPUT ${output} CONTENT "#define PT_HOST\n#include \"${header}\"\n#undef PT_HOST\n")
endfunction()

# Writes a source file with the host part of each choice's header, and sets `units` to the files written.
function(ptbench_write_host_units units) # all further arguments: absolute paths of headers
  set(written "")
  foreach(header ${ARGN})
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${header})
    string(MAKE_C_IDENTIFIER ${name} unit)
    ptbench_write_host_unit(${PROJECT_BINARY_DIR}/generated/${unit}.cpp ${name})
    list(APPEND written ${PROJECT_BINARY_DIR}/generated/${unit}.cpp)
  endforeach()
  set(${units} ${written} PARENT_SCOPE)
endfunction()
