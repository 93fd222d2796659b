#include "variants/cuda/runtime/nvrtc.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <dlfcn.h>
#include <nvrtc.h>

namespace pt::cuda {

namespace {

struct Library {
    decltype(&nvrtcCreateProgram) create = nullptr;
    decltype(&nvrtcDestroyProgram) destroy = nullptr;
    decltype(&nvrtcCompileProgram) compile = nullptr;
    decltype(&nvrtcGetCUBINSize) cubin_size = nullptr;
    decltype(&nvrtcGetCUBIN) cubin = nullptr;
    decltype(&nvrtcGetProgramLogSize) log_size = nullptr;
    decltype(&nvrtcGetProgramLog) log = nullptr;
    decltype(&nvrtcVersion) version = nullptr;
    std::string missing;
};

std::vector<std::string> toolkit_roots() {
    std::vector<std::string> roots;
    for (const char* variable : {"CUDA_HOME", "CUDA_PATH"}) {
        if (const char* value = std::getenv(variable); value != nullptr) {
            roots.emplace_back(value);
        }
    }
    roots.emplace_back("/usr/local/cuda");
    return roots;
}

void* open_library() {
    for (const char* name : {"libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so"}) {
        if (void* handle = dlopen(name, RTLD_NOW | RTLD_LOCAL); handle != nullptr) {
            return handle;
        }
        for (const std::string& root : toolkit_roots()) {
            for (const char* folder : {"/lib64/", "/lib/"}) {  // a toolkit has the first, NVIDIA's wheels the second
                const std::string path = root + folder + name;
                if (void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL); handle != nullptr) {
                    return handle;
                }
            }
        }
    }
    return nullptr;
}

template <class Function>
void resolve(void* handle, const char* name, Function& function, std::string& missing) {
    function = reinterpret_cast<Function>(dlsym(handle, name));
    if (function == nullptr) {
        missing = std::string("libnvrtc lacks ") + name;
    }
}

Library load() {
    Library library;
    void* handle = open_library();
    if (handle == nullptr) {
        library.missing = "libnvrtc (CUDA 12.8 or newer) is not found; set CUDA_HOME";
        return library;
    }
    resolve(handle, "nvrtcCreateProgram", library.create, library.missing);
    resolve(handle, "nvrtcDestroyProgram", library.destroy, library.missing);
    resolve(handle, "nvrtcCompileProgram", library.compile, library.missing);
    resolve(handle, "nvrtcGetCUBINSize", library.cubin_size, library.missing);
    resolve(handle, "nvrtcGetCUBIN", library.cubin, library.missing);
    resolve(handle, "nvrtcGetProgramLogSize", library.log_size, library.missing);
    resolve(handle, "nvrtcGetProgramLog", library.log, library.missing);
    resolve(handle, "nvrtcVersion", library.version, library.missing);
    return library;
}

const Library& library() {
    static const Library loaded = load();
    return loaded;
}

}  // namespace

std::vector<std::string> toolkit_include_options() {
    for (const std::string& root : toolkit_roots()) {
        for (const char* folder : {"/include/cccl", "/include"}) {
            if (std::filesystem::is_directory(root + folder + "/cuda/std")) {
                return {"-I" + root + "/include", "-I" + root + folder};
            }
        }
    }
    return {};
}

std::string nvrtc_missing() {
    if (!library().missing.empty()) {
        return library().missing;
    }
    return toolkit_include_options().empty() ? "the CUDA toolkit's headers (cuda/std) are not found; set CUDA_HOME"
                                             : "";
}

std::string nvrtc_version() {
    int major = 0, minor = 0;
    if (!library().missing.empty() || library().version(&major, &minor) != NVRTC_SUCCESS) {
        return "";
    }
    return std::to_string(major) + "." + std::to_string(minor);
}

Compilation compile(const std::string& source, const std::string& name, const std::vector<std::string>& options) {
    const Library& nvrtc = library();
    if (!nvrtc.missing.empty()) {
        throw std::runtime_error(nvrtc.missing);
    }
    const auto start = std::chrono::steady_clock::now();
    nvrtcProgram program = nullptr;
    if (nvrtc.create(&program, source.c_str(), name.c_str(), 0, nullptr, nullptr) != NVRTC_SUCCESS) {
        throw std::runtime_error("NVRTC cannot take the program " + name);
    }
    std::vector<const char*> arguments;
    for (const std::string& option : options) {
        arguments.push_back(option.c_str());
    }
    Compilation result;
    result.succeeded = nvrtc.compile(program, static_cast<int>(arguments.size()), arguments.data()) == NVRTC_SUCCESS;
    std::size_t size = 0;
    if (nvrtc.log_size(program, &size) == NVRTC_SUCCESS && size > 1) {
        result.log.resize(size);
        nvrtc.log(program, result.log.data());
        result.log.resize(size - 1);
    }
    if (result.succeeded && nvrtc.cubin_size(program, &size) == NVRTC_SUCCESS) {
        result.cubin.resize(size);
        nvrtc.cubin(program, result.cubin.data());
    }
    nvrtc.destroy(&program);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

}  // namespace pt::cuda
