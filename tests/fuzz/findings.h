// What fuzz targets share: an InputError of one line is a good answer to any input. Any other exception, a crash, a
// hang or a broken promise about what was accepted is a finding, and ends the target.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "harness/failure.h"

// Under libFuzzer the name that its main calls; in fuzz_corpus_test one name a target (tests/fuzz/CMakeLists.txt).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pt::fuzz {

inline void require(bool holds, const std::string& what) {
    if (!holds) {
        throw std::logic_error(what);
    }
}

// Runs `read()`; what it refuses, it must refuse in one line.
template <class Read>
void accept_or_refuse(const Read& read) {
    try {
        read();
    } catch (const InputError& error) {
        const std::string line = error.what();
        require(!line.empty() && line.find('\n') == std::string::npos, "an error that is not one line: " + line);
    }
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace pt::fuzz
