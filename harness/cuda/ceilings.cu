#include "harness/cuda/ceilings.h"

#include "harness/cuda/probe.h"

namespace pt::cuda {

namespace {

constexpr unsigned threads = 256;
constexpr int rounds = 256;
constexpr int steps = 32;  // unrolled steps in a round of the loop whose speed is measured
constexpr int chains = 8;  // independent chains of instructions, so that none waits for the previous one

enum class Mix { issue, fma, alu, xu };

// Runs a loop of instructions whose speed is measured: a step is one in each chain, or two for Mix::issue (fma, alu).
template <Mix mix>
__global__ void __launch_bounds__(threads) execute(float* result, float seed) {
    float x[chains];
    unsigned y[chains];
    for (int chain = 0; chain < chains; ++chain) {
        x[chain] = seed + static_cast<float>(threadIdx.x + chain);
        y[chain] = threadIdx.x + chain;
    }
    for (int round = 0; round < rounds; ++round) {
#pragma unroll
        for (int step = 0; step < steps; ++step) {
#pragma unroll
            for (int chain = 0; chain < chains; ++chain) {
                if (mix == Mix::fma || mix == Mix::issue) {
                    asm volatile("fma.rn.f32 %0, %0, %0, %0;" : "+f"(x[chain]));
                }
                if (mix == Mix::alu || mix == Mix::issue) {
                    asm volatile("lop3.b32 %0, %0, %1, %2, 0x96;"
                                 : "+r"(y[chain])
                                 : "r"(y[(chain + 1) % chains]), "r"(step));
                }
                if (mix == Mix::xu) {
                    asm volatile("ex2.approx.ftz.f32 %0, %0;" : "+f"(x[chain]));
                }
            }
        }
    }
    float sum = 0;
    for (int chain = 0; chain < chains; ++chain) {
        sum += x[chain] + static_cast<float>(y[chain]);
    }
    result[blockIdx.x * threads + threadIdx.x] = sum;
}

template <Mix mix>
double warp_instructions_per_second(const Timer& timer, float* result, unsigned blocks) {
    const double seconds = timer.fastest([&] { execute<mix><<<blocks, threads>>>(result, 1.0f); });
    const double per_warp = double(rounds) * steps * chains * (mix == Mix::issue ? 2 : 1);
    return per_warp * blocks * (threads / 32) / seconds;
}

}  // namespace

Ceilings measure_ceilings() {
    cudaDeviceProp properties{};
    PT_CUDA_CHECK(cudaGetDeviceProperties(&properties, 0));
    const unsigned blocks = static_cast<unsigned>(properties.multiProcessorCount) *
                            static_cast<unsigned>(properties.maxThreadsPerMultiProcessor / static_cast<int>(threads)) *
                            4;
    const Timer timer;
    Ceilings ceilings;
    {
        const Memory result(sizeof(float) * threads * blocks);
        ceilings.issue = warp_instructions_per_second<Mix::issue>(timer, result.as<float>(), blocks);
        ceilings.fma = warp_instructions_per_second<Mix::fma>(timer, result.as<float>(), blocks);
        ceilings.alu = warp_instructions_per_second<Mix::alu>(timer, result.as<float>(), blocks);
        ceilings.xu = warp_instructions_per_second<Mix::xu>(timer, result.as<float>(), blocks);
    }
    const std::size_t bytes = std::size_t{256} << 20;
    const Memory from(bytes), to(bytes);
    const double seconds = timer.fastest(
        [&] { PT_CUDA_CHECK(cudaMemcpyAsync(to.as<void>(), from.as<void>(), bytes, cudaMemcpyDeviceToDevice)); });
    ceilings.memory = 2.0 * static_cast<double>(bytes) / seconds;
    return ceilings;
}

}  // namespace pt::cuda
