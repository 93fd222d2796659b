// The one check on calls of the CUDA runtime, a macro that evaluates its argument once and throws with file, line and
// expression.
#pragma once

#include <stdexcept>
#include <string>

#include <cuda_runtime_api.h>

namespace pt::cuda {

class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class OutOfMemory : public Error {
public:
    OutOfMemory(std::size_t asked, std::size_t free)
        : Error("out of device memory: asked for " + std::to_string(asked >> 20) + " MiB, free are " +
                std::to_string(free >> 20) + " MiB") {}
};

inline void check(cudaError_t code, const char* expression, const char* file, int line) {
    if (code != cudaSuccess) {
        (void)cudaGetLastError();  // clears CUDA's last error, which the next check would report
        throw Error(std::string(file) + ":" + std::to_string(line) + ": " + expression + ": " +
                    cudaGetErrorString(code));
    }
}

}  // namespace pt::cuda

#define PT_CUDA_CHECK(expression) ::pt::cuda::check((expression), #expression, __FILE__, __LINE__)

namespace pt::cuda {

// Whether a stream's or an event's work is done, by the result of cudaStreamQuery or cudaEventQuery.
inline bool is_ready(cudaError_t found) {
    if (found == cudaErrorNotReady) {
        (void)cudaGetLastError();  // CUDA keeps "not ready" as its last error
        return false;
    }
    PT_CUDA_CHECK(found);
    return true;
}

}  // namespace pt::cuda
