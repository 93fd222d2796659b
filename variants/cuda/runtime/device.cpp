#include "variants/cuda/runtime/device.h"

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

std::string version_text(int version) {
    return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

std::string device_missing() {
    int driver = 0, runtime = 0, count = 0;
    (void)cudaDriverGetVersion(&driver);
    (void)cudaRuntimeGetVersion(&runtime);
    const cudaError_t error = cudaGetDeviceCount(&count);
    (void)cudaGetLastError();
    if (error == cudaErrorInsufficientDriver && driver == 0) {
        return "no NVIDIA driver";
    }
    if (error == cudaErrorInsufficientDriver) {
        return "the driver is for CUDA " + version_text(driver) + ", this ptbench needs one for CUDA " +
               version_text(runtime);
    }
    if (error != cudaSuccess) {
        return cudaGetErrorString(error);
    }
    return count == 0 ? "no CUDA device" : "";
}

namespace {

int attribute(cudaDeviceAttr which) {
    int value = 0;
    PT_CUDA_CHECK(cudaDeviceGetAttribute(&value, which, 0));
    return value;
}

// A driver that does not know the attribute of the multi-process service returns an error, which counts as no.
bool has_multi_process_service() {
#if CUDART_VERSION >= 12080
    int value = 0;
    if (cudaDeviceGetAttribute(&value, cudaDevAttrMpsEnabled, 0) == cudaSuccess) {
        return value != 0;
    }
    (void)cudaGetLastError();
#endif
    return false;
}

bool is_like_first(int other) {
    cudaDeviceProp properties{};
    PT_CUDA_CHECK(cudaGetDeviceProperties(&properties, other));
    const Device& first = device();
    return properties.name == first.name && properties.major == first.major && properties.minor == first.minor &&
           properties.multiProcessorCount == first.multiprocessors && properties.totalGlobalMem == first.memory_bytes;
}

Device read_device() {
    Device d;
    cudaDeviceProp properties{};
    PT_CUDA_CHECK(cudaGetDeviceProperties(&properties, 0));
    d.name = properties.name;
    d.major = properties.major;
    d.minor = properties.minor;
    d.multiprocessors = properties.multiProcessorCount;
    d.memory_bytes = properties.totalGlobalMem;
    d.clock_khz = attribute(cudaDevAttrClockRate);
    d.memory_clock_khz = attribute(cudaDevAttrMemoryClockRate);
    d.memory_bus_bits = attribute(cudaDevAttrGlobalMemoryBusWidth);
    d.l2_bytes = attribute(cudaDevAttrL2CacheSize);
    d.ecc = attribute(cudaDevAttrEccEnabled) != 0;
    d.mps = has_multi_process_service();
    PT_CUDA_CHECK(cudaDriverGetVersion(&d.driver_version));
    PT_CUDA_CHECK(cudaRuntimeGetVersion(&d.runtime_version));
    return d;
}

}  // namespace

int equal_devices() {
    static const int count = [] {
        int all = 0, alike = 1;
        PT_CUDA_CHECK(cudaGetDeviceCount(&all));
        for (int other = 1; other < all && is_like_first(other); ++other) {
            alike += 1;
        }
        return alike;
    }();
    return count;
}

const Device& device() {
    static const Device first = read_device();
    return first;
}

}  // namespace pt::cuda
