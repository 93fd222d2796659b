#include "variants/cuda/runtime/compiler_report.h"

#include <regex>
#include <sstream>

namespace pt::cuda {

std::vector<KernelReport> parse_ptxas_log(const std::string& log) {
    static const std::regex entry(R"(Compiling entry function '([^']+)')");
    static const std::regex properties(R"(Function properties for (\S+))");
    static const std::regex stack(R"((\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads)");
    static const std::regex registers(R"(Used (\d+) registers)");
    static const std::regex shared(R"((\d+) bytes smem)");
    std::vector<KernelReport> kernels;
    std::string function;  // name of the function that the log's next lines describe: the kernel, or one that it calls
    std::istringstream lines(log);
    std::smatch found;
    for (std::string line; std::getline(lines, line);) {
        if (std::regex_search(line, found, entry)) {
            kernels.push_back({.name = found[1]});
            function = found[1];
        } else if (std::regex_search(line, found, properties)) {
            function = found[1];
        } else if (!kernels.empty() && function == kernels.back().name && std::regex_search(line, found, stack)) {
            kernels.back().stack_bytes = std::stoi(found[1]);
            kernels.back().spill_store_bytes = std::stoi(found[2]);
            kernels.back().spill_load_bytes = std::stoi(found[3]);
        } else if (!kernels.empty() && std::regex_search(line, found, registers)) {
            kernels.back().registers = std::stoi(found[1]);
            kernels.back().shared_bytes = std::regex_search(line, found, shared) ? std::stoi(found[1]) : 0;
        }
    }
    return kernels;
}

}  // namespace pt::cuda
