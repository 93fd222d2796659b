// The device's sequences for division, reciprocal and square root round as IEEE's operators do over the whole ranges
// that in_range.h promises. Skipped where there is no GPU.
#include <gtest/gtest.h>

#include "kernels/in_range.h"
#include "kernels/rng.h"
#include "variants/cuda/runtime/check.h"

namespace pt::test {
namespace {

constexpr std::uint32_t threads = 256, blocks = 1024, rounds = 1024;  // 2.7e8 operands an operation

struct Differences {
    unsigned long long reciprocal, quotient, root;
    float operand[2];  // of one of them
};

// A number of either sign between 2^lowest and 2^highest, evenly by exponent.
__device__ float number_between(int lowest, int highest, std::uint32_t bits, std::uint32_t choice) {
    const int exponent = lowest + static_cast<int>(choice % static_cast<std::uint32_t>(highest - lowest));
    const std::uint32_t sign = choice & 0x80000000u;
    return __uint_as_float(sign | (static_cast<std::uint32_t>(exponent + 127) << 23) | (bits & 0x7fffffu));
}

__device__ void compare(float sequence, float exact, float a, float b, unsigned long long& count, Differences& all) {
    if (__float_as_uint(sequence) != __float_as_uint(exact)) {
        atomicAdd(&count, 1ull);
        all.operand[0] = a;
        all.operand[1] = b;
    }
}

__global__ void count_differences(Differences* differences) {
    const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    for (std::uint32_t round = 0; round < rounds; ++round) {
        const RandomWords words = pcg4d({thread, round, 1u, 2u});
        const float x = number_between(-100, 120, words.x, words.y);
        compare(reciprocal_in_range(x), __frcp_rn(x), x, 0, differences->reciprocal, *differences);
        const float a = round == 0 ? 0.0f : number_between(-50, 50, words.z, words.y);
        const float b = number_between(-50, 50, words.x, words.w);
        compare(divide_in_range(a, b), __fdiv_rn(a, b), a, b, differences->quotient, *differences);
        const float square = fabsf(number_between(-100, 127, words.w, words.x));
        compare(square_root_in_range(square), __fsqrt_rn(square), square, 0, differences->root, *differences);
    }
}

// Whole multiples of 2^-23, as concentric_disc divides them: operands and quotients with few bits, ties among them.
__global__ void count_short_differences(Differences* differences) {
    const std::uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    for (std::uint32_t round = 0; round < rounds; ++round) {
        const RandomWords words = pcg4d({thread, round, 3u, 4u});
        const std::uint32_t divisor = 1u + words.x % 0x7fffffu;
        const float b = static_cast<float>(divisor) * 0x1p-23f;
        const float a = static_cast<float>(words.y % (divisor + 1)) * 0x1p-23f;
        compare(divide_in_range(a, b), __fdiv_rn(a, b), a, b, differences->quotient, *differences);
    }
}

TEST(InRange, RoundsAsTheOperators) {
    int devices = 0;
    if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
        GTEST_SKIP() << "no GPU";
    }
    Differences* on_device = nullptr;
    PT_CUDA_CHECK(cudaMalloc(&on_device, sizeof(Differences)));
    PT_CUDA_CHECK(cudaMemset(on_device, 0, sizeof(Differences)));
    count_differences<<<blocks, threads>>>(on_device);
    count_short_differences<<<blocks, threads>>>(on_device);
    PT_CUDA_CHECK(cudaGetLastError());
    Differences found{};
    PT_CUDA_CHECK(cudaMemcpy(&found, on_device, sizeof found, cudaMemcpyDeviceToHost));
    PT_CUDA_CHECK(cudaFree(on_device));
    EXPECT_EQ(found.reciprocal, 0u) << found.operand[0];
    EXPECT_EQ(found.quotient, 0u) << found.operand[0] << " / " << found.operand[1];
    EXPECT_EQ(found.root, 0u) << found.operand[0];
}

}  // namespace
}  // namespace pt::test
