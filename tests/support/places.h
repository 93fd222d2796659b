// The places of the repository, the program under test and what tests load into it. One file of the build knows: with
// the clone's folder on its command line, no test's object could be taken from a compiler cache by another clone.
#pragma once

#include <string>

namespace pt::test {

// The repository's folder, without a slash at its end.
std::string source_folder();

// A file or folder of the repository, named from its root.
std::string in_source(const std::string& path);

// The path of the ptbench program of this build.
std::string program_file();

// The ptbench program with the variants of tests/wrong.
std::string program_with_wrong_variants();

// tests/preload/kill_at.cpp as a library for LD_PRELOAD.
std::string kill_at_library();
std::string set_clock_back_library();  // tests/preload/set_clock_back.cpp, likewise

}  // namespace pt::test
