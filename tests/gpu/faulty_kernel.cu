// A kernel that ends in a trap, for faults_test.cpp.
#include <cuda_runtime_api.h>

__global__ void fault() { __trap(); }

cudaError_t run_faulty_kernel() {
    fault<<<1, 1>>>();
    return cudaDeviceSynchronize();
}
