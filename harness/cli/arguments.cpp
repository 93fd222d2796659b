#include <algorithm>

#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/json_reader.h"
#include "harness/scene/places.h"
#include "harness/words.h"
#include "variants/registry.h"

namespace pt {

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

std::pair<std::uint32_t, std::uint32_t> parse_resolution(const std::string& text) {
    const auto sides = parse_pair(text, 'x');
    const auto [width, height] = sides.value_or(std::pair(0u, 0u));
    if (width == 0 || height == 0 || width > 65536 || height > 65536 || std::uint64_t{width} * height > (1u << 26)) {
        throw InputError("--resolution", "argument", "\"" + text + "\"",
                         "WxH with sides from 1 to 65536 and at most 2^26 pixels");
    }
    return *sides;
}

std::vector<std::uint32_t> parse_whole_numbers(const std::string& text, const std::string& flag, std::uint32_t low,
                                               std::uint32_t high) {
    std::vector<std::uint32_t> numbers;
    for (const std::string& part : split_at_commas(text)) {
        const auto number = parse_number<std::uint32_t>(part);
        if (!number || *number < low || *number > high) {
            throw InputError(flag, "argument", "\"" + text + "\"",
                             fmt::format("whole numbers from {} to {} with a comma between them", low, high));
        }
        numbers.push_back(*number);
        check_once(numbers, flag, "argument");
    }
    return numbers;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> parse_resolutions(const std::string& text) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
    for (const std::string& part : split_at_commas(text)) {
        sizes.push_back(parse_resolution(part));
        if (std::count(sizes.begin(), sizes.end(), sizes.back()) > 1) {
            throw InputError("--resolution", "argument", "\"" + part + "\" twice", "once");
        }
    }
    return sizes;
}

std::vector<std::string> split_names(const std::string& text, const std::string& flag) {
    std::vector<std::string> names;
    for (std::string& name : split_at_commas(text)) {
        if (name.empty()) {
            throw InputError(flag, "argument", "\"" + text + "\"", "names or files with a comma between them");
        }
        names.push_back(std::move(name));
        check_once(names, flag, "argument");
    }
    return names;
}

std::vector<std::string> scenes_asked_for(const std::string& text) {
    return text == "all" ? scene_names() : split_names(text);
}

Backend parse_backend(const std::string& text) {
    if (text.empty()) {
        return cuda::not_available().empty() ? Backend::cuda : Backend::cpu;
    }
    for (const Backend backend : all_backends) {
        if (text == to_string(backend)) {
            if (Registry::instance().choices(axes::integrator, backend).empty()) {
                require_backend(backend);  // require_backend() throws: without integrators the build lacks the backend
            }
            return backend;
        }
    }
    throw InputError("--backend", "argument", "\"" + text + "\"", "cpu, cuda");
}

void require_backend(Backend backend) {
    if (backend == Backend::cuda && !cuda::not_available().empty()) {
        throw MachineError("cuda: not available (" + cuda::not_available() + ")");
    }
}

std::string check_not_empty(const std::string& text) { return text.empty() ? "found an empty name" : ""; }

std::string check_seed(const std::string& text) {
    return parse_number<std::uint64_t>(text) ? "" : "Value " + text + " not a whole number from 0 to 2^64 - 1";
}

void add_compile_options(CLI::App& command, CompileOnly& compile_only) {
    CLI::Option* const flag = command.add_flag(
        "--compile", compile_only.is_asked,
        "Compile the CUDA kernels that the call would use into the cache ($XDG_CACHE_HOME/ptbench), and nothing else; "
        "needs no GPU, and the cache can travel to one");
    CLI::Option* const architecture =
        command.add_option("--arch", compile_only.architecture, "GPU architecture of --compile, e.g. sm_90");
    architecture->needs(flag)->check([](const std::string& name) { return cuda::why_not_an_architecture(name); });
    flag->needs(architecture);
}

}  // namespace pt
