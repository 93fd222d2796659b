// Measures the clock of the GPU's multiprocessors: cycles of a chain of additions against a nanosecond timer.
#include "harness/cuda/clock.h"
#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

namespace {

__global__ void count_cycles(unsigned long long* result, unsigned seed) {
    unsigned long long time_begin = 0, time_end = 0;
    asm volatile("mov.u64 %0, %globaltimer;" : "=l"(time_begin)::"memory");
    const long long cycles_begin = clock64();
    unsigned x = seed;
    for (int i = 0; i < 100000; ++i) {
        asm volatile("add.u32 %0, %0, %0;" : "+r"(x));
    }
    const long long cycles_end = clock64();
    asm volatile("mov.u64 %0, %globaltimer;" : "=l"(time_end)::"memory");
    result[0] = static_cast<unsigned long long>(cycles_end - cycles_begin);
    result[1] = time_end - time_begin;
    result[2] = x;
}

}  // namespace

double measure_clock_mhz() {
    struct Result {
        unsigned long long* memory = nullptr;
        Result() { PT_CUDA_CHECK(cudaMalloc(&memory, 3 * sizeof(unsigned long long))); }
        ~Result() { (void)cudaFree(memory); }
    };
    static const Result result;
    unsigned long long host[3] = {};
    count_cycles<<<1, 1>>>(result.memory, 1);
    PT_CUDA_CHECK(cudaGetLastError());
    PT_CUDA_CHECK(cudaMemcpy(host, result.memory, sizeof host, cudaMemcpyDeviceToHost));
    return host[1] == 0 ? 0 : 1e3 * static_cast<double>(host[0]) / static_cast<double>(host[1]);
}

}  // namespace pt::cuda
