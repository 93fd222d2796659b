#include "variants/cuda/runtime/nccl.h"

#include <cstdlib>
#include <map>
#include <numeric>
#include <type_traits>

#include <dlfcn.h>

#if __has_include(<nccl.h>)
#include <nccl.h>
#define PT_HAS_NCCL_HEADER 1
#endif

#include "variants/cuda/runtime/on_device.h"

namespace pt::cuda {

namespace {

// NCCL's types and constants, which nccl.h has had unchanged since NCCL 2.0.
using NcclResult = int;
struct NcclCommunicator;
constexpr NcclResult nccl_success = 0;
constexpr int nccl_int64 = 4;
constexpr int nccl_sum = 0;
#ifdef PT_HAS_NCCL_HEADER
static_assert(static_cast<int>(ncclSuccess) == nccl_success && static_cast<int>(ncclInt64) == nccl_int64 &&
              static_cast<int>(ncclSum) == nccl_sum && sizeof(ncclResult_t) == sizeof(NcclResult));
#endif

struct NcclLibrary {
    NcclResult (*version)(int*) = nullptr;
    NcclResult (*make_all)(NcclCommunicator**, int, const int*) = nullptr;
    NcclResult (*abort)(NcclCommunicator*) = nullptr;
    NcclResult (*group_start)() = nullptr;
    NcclResult (*group_end)() = nullptr;
    NcclResult (*reduce)(const void*, void*, std::size_t, int, int, int, NcclCommunicator*, cudaStream_t) = nullptr;
    const char* (*error_text)(NcclResult) = nullptr;
    std::string missing;
};

void* open_nccl() {
    if (const char* const own = std::getenv("PTBENCH_NCCL"); own != nullptr && *own != '\0') {
        return dlopen(own, RTLD_NOW | RTLD_LOCAL);
    }
    for (const char* const name : {"libnccl.so.2", "/usr/local/cuda/lib64/libnccl.so.2"}) {
        if (void* const handle = dlopen(name, RTLD_NOW | RTLD_LOCAL); handle != nullptr) {
            return handle;
        }
    }
    return nullptr;
}

NcclLibrary load_nccl() {
    NcclLibrary library;
    void* const handle = open_nccl();
    if (handle == nullptr) {
        library.missing =
            "libnccl.so.2 is not found (it comes with the CUDA toolkit and with PyTorch); set PTBENCH_NCCL to its path";
        return library;
    }
    const auto resolve = [&](const char* name, auto& function) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
        if (function == nullptr) {
            library.missing = std::string("libnccl.so.2 lacks ") + name;
        }
    };
    resolve("ncclGetVersion", library.version);
    resolve("ncclCommInitAll", library.make_all);
    resolve("ncclCommAbort", library.abort);
    resolve("ncclGroupStart", library.group_start);
    resolve("ncclGroupEnd", library.group_end);
    resolve("ncclReduce", library.reduce);
    resolve("ncclGetErrorString", library.error_text);
    return library;
}

const NcclLibrary& nccl() {
    static const NcclLibrary loaded = load_nccl();
    return loaded;
}

void check_nccl(NcclResult result, const char* call) {
    if (result != nccl_success) {
        throw Error(std::string(call) + ": " + nccl().error_text(result));
    }
}

// NCCL communicators by number of devices, one per device. Those left over are not destroyed: the driver may be gone
// when the process ends.
std::map<std::size_t, std::vector<NcclCommunicator*>>& connections() {
    static auto& made = *new std::map<std::size_t, std::vector<NcclCommunicator*>>;
    return made;
}

// Adds one device's values to the sum on the first device; what the other devices receive is not read.
NcclResult enqueue(const Addend& addend, std::int64_t* sum, std::size_t count) {
    const OnDevice on(static_cast<int>(addend.device));
    NcclCommunicator* const own = connections().at(addend.devices).at(addend.device);
    return nccl().reduce(addend.values, addend.device == 0 ? sum : nullptr, count, nccl_int64, nccl_sum, 0, own,
                         addend.stream);
}

}  // namespace

std::string nccl_missing() { return nccl().missing; }

std::string nccl_version() {
    int version = 0;
    if (!nccl().missing.empty() || nccl().version(&version) != nccl_success) {
        return "";
    }
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
           std::to_string(version % 100);
}

void connect_devices(const std::vector<Addend>& addends, std::int64_t* sum, std::size_t count) {
    std::vector<NcclCommunicator*>& all = connections()[addends.size()];
    if (all.empty()) {
        std::vector<int> numbers(addends.size());
        std::iota(numbers.begin(), numbers.end(), 0);
        std::vector<NcclCommunicator*> fresh(addends.size());
        const OnDevice first(0);
        check_nccl(nccl().make_all(fresh.data(), static_cast<int>(fresh.size()), numbers.data()), "ncclCommInitAll");
        all = std::move(fresh);
    }
    // One thread may enqueue the parts of all devices only within an NCCL group.
    check_nccl(nccl().group_start(), "ncclGroupStart");
    NcclResult failed = nccl_success;
    for (std::size_t i = 0; i < addends.size() && failed == nccl_success; ++i) {
        failed = enqueue(addends[i], sum, count);
    }
    const NcclResult ended = nccl().group_end();
    check_nccl(failed, "ncclReduce");
    check_nccl(ended, "ncclGroupEnd");
}

void add_to_first(const Addend& addend, std::int64_t* sum, std::size_t count) {
    check_nccl(enqueue(addend, sum, count), "ncclReduce");
}

void disconnect_devices() {
    for (const auto& [devices, all] : connections()) {
        for (NcclCommunicator* const one : all) {
            (void)nccl().abort(one);  // ignores errors: the call that failed has been reported
        }
    }
    connections().clear();
}

}  // namespace pt::cuda
