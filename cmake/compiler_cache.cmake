# The sanitizers' ignore list is named relative to the build folder, so that commands are equal in all clones.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=.*undefined")
  file(RELATIVE_PATH ignorelist ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/cmake/sanitize_ignorelist.txt)
  add_compile_options(-fsanitize-ignorelist=${ignorelist})
endif()

# ccache, where installed, reuses compiled objects of this or another clone, keyed by the compiler, its options and all
# files read; precompiled headers count by content. Paths are relative to the clone, so that a debugger may show another
# clone's files. CMake passes precompiled headers to clang by an option that ccache does not rewrite, so that clang's
# objects are reused only within their own clone.
option(PTBENCH_COMPILER_CACHE "Compile through ccache where it is found" ON)
if(PTBENCH_COMPILER_CACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(PTBENCH_CCACHE ccache)
endif()
if(PTBENCH_COMPILER_CACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND PTBENCH_CCACHE)
  # ccache hashes -march=native literally, so its meaning on this machine separates the caches of different machines.
  # The compiler is asked in a fixed folder because clang prints the folder as well.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=${PTBENCH_MARCH} -E -v -x c++ /dev/null
                  WORKING_DIRECTORY / OUTPUT_VARIABLE means ERROR_VARIABLE means)
  string(SHA256 means "${means}")
  # The first two of ccache's sloppiness settings are needed for precompiled headers, as it does not see which macros
  # those define. The ignore list is named as an extra file, as ccache misses that -fsanitize-ignorelist= reads it.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_NAMESPACE=${means} CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_EXTRAFILES=${PROJECT_SOURCE_DIR}/cmake/sanitize_ignorelist.txt ${PTBENCH_CCACHE})
  if(NOT CMAKE_CUDA_COMPILER_LAUNCHER)
    set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
  endif()
  # Without this option clang rejects a precompiled header that is older than the source files of a new clone.
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()
