#include "tests/support/places.h"

namespace pt::test {

std::string source_folder() { return PTBENCH_SOURCE_DIR; }

std::string in_source(const std::string& path) { return source_folder() + "/" + path; }

std::string program_file() { return PTBENCH_BINARY; }

std::string program_with_wrong_variants() { return PTBENCH_WRONG; }

std::string kill_at_library() { return PTBENCH_KILL_AT; }

std::string set_clock_back_library() { return PTBENCH_SET_CLOCK_BACK; }

}  // namespace pt::test
