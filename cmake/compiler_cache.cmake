# What was compiled before, in this clone or in another, is taken from ccache where that is installed. It is keyed by what
# the compiler reads and by its options; a precompiled header by its content. Folders are hashed relative to the clone.
option(PTBENCH_COMPILER_CACHE "Compile through ccache where it is found" ON)
if(PTBENCH_COMPILER_CACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(PTBENCH_CCACHE ccache)
  if(PTBENCH_CCACHE)
    # Precompiled headers need the first two words: ccache does not see which macros they define. With -Winvalid-pch and
    # -Werror, one that does not fit the options ends the build.
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${PTBENCH_CCACHE})
    set(CMAKE_CUDA_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
  endif()
endif()
