# Named from the build's folder, so that a command does not differ by the clone for it.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=.*undefined")
  file(RELATIVE_PATH ignorelist ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/cmake/sanitize_ignorelist.txt)
  add_compile_options(-fsanitize-ignorelist=${ignorelist})
endif()

# What was compiled before, in this clone or in another, is taken from ccache where that is installed: by the compiler, its
# options and all that it reads, a precompiled header by its content. Folders are taken relative to the clone, so a debugger
# may be shown another clone's. CMake passes clang its precompiled header by a word that ccache does not rewrite: what clang
# compiled is found again in its own clone alone.
option(PTBENCH_COMPILER_CACHE "Compile through ccache where it is found" ON)
if(PTBENCH_COMPILER_CACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(PTBENCH_CCACHE ccache)
endif()
if(PTBENCH_COMPILER_CACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND PTBENCH_CCACHE)
  # ccache takes -march=native by the word: what that is on this machine keeps the caches of two machines apart. Asked in
  # one folder, which clang tells as well.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=${PTBENCH_MARCH} -E -v -x c++ /dev/null
                  WORKING_DIRECTORY / OUTPUT_VARIABLE means ERROR_VARIABLE means)
  string(SHA256 means "${means}")
  # Precompiled headers need the first two of the words: ccache does not see which macros they define. It does not know
  # that -fsanitize-ignorelist= names a file that the compiler reads.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_NAMESPACE=${means} CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
      CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_EXTRAFILES=${PROJECT_SOURCE_DIR}/cmake/sanitize_ignorelist.txt ${PTBENCH_CCACHE})
  if(NOT CMAKE_CUDA_COMPILER_LAUNCHER)
    set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
  endif()
  # clang would refuse a precompiled header that is older than the files of a new clone.
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()
