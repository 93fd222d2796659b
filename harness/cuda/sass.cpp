#include "harness/cuda/sass.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/cuda/is_program.h"
#include "harness/failure.h"
#include "harness/scene/places.h"

namespace pt::cuda {

namespace fs = std::filesystem;

namespace {

struct Instruction {
    std::string mnemonic;
    std::string label;   // name of a label, if this line of the disassembly is one
    std::string target;  // label to which a branch instruction leads; else empty
};

bool starts_with_any(const std::string& text, std::initializer_list<const char*> starts) {
    for (const char* start : starts) {
        if (text.rfind(start, 0) == 0) {
            return true;
        }
    }
    return false;
}

void count(PipeCounts& counts, const std::vector<Instruction>& code, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
        if (code[i].label.empty()) {
            counts[pipe_of(code[i].mnemonic)] += 1;
        }
    }
}

KernelCode counted(const std::string& name, const std::vector<Instruction>& code) {
    KernelCode kernel{.name = name, .all = {}, .loop = {}};
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < code.size(); ++i) {
        if (!code[i].label.empty()) {
            places[code[i].label] = i;
        }
    }
    std::size_t begin = 0, end = 0;
    for (std::size_t i = 0; i < code.size(); ++i) {
        const auto place = places.find(code[i].target);
        // A branch to itself is the trap that the compiler puts behind the code.
        if (place != places.end() && place->second + 1 < i && i + 1 - place->second > end - begin) {
            begin = place->second;
            end = i + 1;
        }
    }
    count(kernel.all, code, 0, code.size());
    count(kernel.loop, code, begin, end);
    return kernel;
}

// A temporary file that the destructor removes.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& contents) {
        path_ = (fs::temp_directory_path() / fmt::format("ptbench-{}.cubin", ::getpid())).string();
        std::ofstream(path_, std::ios::binary) << contents;
    }
    ~TemporaryFile() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

}  // namespace

std::string pipe_of(const std::string& mnemonic) {
    static const std::set<std::string> fma{"FFMA", "FMUL", "FADD", "IMAD", "FFMA32I", "IDP", "HFMA2", "HADD2", "HMUL2"};
    static const std::set<std::string> xu{"MUFU", "I2F", "F2I", "F2F", "I2I", "FRND", "POPC", "FLO", "BREV"};
    static const std::set<std::string> control{"BRA",  "BRX", "JMP",  "BSSY",   "BSYNC",  "BREAK",
                                               "CALL", "RET", "EXIT", "NOP",    "YIELD",  "WARPSYNC",
                                               "BMOV", "BPT", "KILL", "RPCMOV", "DEPBAR", "NANOSLEEP"};
    const std::string opcode = mnemonic.substr(0, mnemonic.find('.'));
    if (fma.contains(opcode)) {
        return "fma";
    }
    if (xu.contains(opcode)) {
        return "xu";
    }
    if (starts_with_any(opcode, {"DADD", "DMUL", "DFMA", "DSETP", "DMNMX"})) {
        return "fp64";
    }
    if (starts_with_any(opcode, {"LD", "ST", "ATOM", "RED", "SHFL", "VOTE", "BAR", "MATCH", "MEMBAR", "CCTL"})) {
        return "lsu";
    }
    if (control.contains(opcode)) {
        return "control";
    }
    return opcode[0] == 'U' || opcode == "R2UR" ? "uniform" : "alu";
}

std::vector<KernelCode> count_instructions(const std::string& disassembly) {
    static const std::regex section(R"(^\.text\.(\S+):)");
    static const std::regex label(R"(^(\.L_\S+):)");
    static const std::regex line_of_code(R"(^\s+/\*[0-9a-f]{4,}\*/\s+(?:@!?U?P\w+\s+)?([A-Z][A-Z0-9_.]*)(.*))");
    static const std::regex branch(R"(`\((\.L_\S+)\))");
    std::vector<std::pair<std::string, std::vector<Instruction>>> kernels;
    std::istringstream lines(disassembly);
    std::smatch found;
    for (std::string line; std::getline(lines, line);) {
        if (std::regex_search(line, found, section)) {
            kernels.emplace_back(found[1], std::vector<Instruction>());
        } else if (kernels.empty()) {
            continue;
        } else if (std::regex_search(line, found, label)) {
            kernels.back().second.push_back({.mnemonic = "", .label = found[1], .target = ""});
        } else if (std::regex_search(line, found, line_of_code)) {
            Instruction instruction{.mnemonic = found[1], .label = "", .target = ""};
            const std::string rest = found[2];
            if (instruction.mnemonic.rfind("BRA", 0) == 0 && std::regex_search(rest, found, branch)) {
                instruction.target = found[1];
            }
            kernels.back().second.push_back(instruction);
        }
    }
    std::vector<KernelCode> counted_kernels;
    for (const auto& [name, code] : kernels) {
        counted_kernels.push_back(counted(name, code));
    }
    return counted_kernels;
}

std::string find_nvdisasm() {
    if (const char* named = std::getenv("PTBENCH_NVDISASM"); named != nullptr) {
        return is_program(named) ? named : "";
    }
    std::vector<fs::path> folders;
    std::istringstream path(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(path, folder, ':');) {
        folders.emplace_back(folder);
    }
    for (const char* variable : {"CUDA_HOME", "CUDA_PATH"}) {
        if (const char* root = std::getenv(variable); root != nullptr) {
            folders.push_back(fs::path(root) / "bin");
        }
    }
    folders.emplace_back("/usr/local/cuda/bin");
    std::error_code ignored;
    for (const auto& python : fs::directory_iterator(home_folder() / ".venv/lib", ignored)) {
        for (const char* toolkit : {"cu13", "cu12"}) {
            folders.push_back(python.path() / "site-packages/nvidia" / toolkit / "bin");
        }
    }
    for (const fs::path& folder : folders) {
        if (is_program(folder / "nvdisasm")) {
            return (folder / "nvdisasm").string();
        }
    }
    return "";
}

std::string disassemble(const std::string& nvdisasm, const std::string& cubin) {
    const TemporaryFile file(cubin);
    const std::string command = fmt::format("'{}' -c '{}' 2>&1", nvdisasm, file.path());
    FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) {
        throw MachineError(fmt::format("{}: cannot be run", nvdisasm));
    }
    std::string text;
    std::array<char, 65536> buffer{};
    for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
        text.append(buffer.data(), got);
    }
    if (::pclose(pipe) != 0) {
        throw MachineError(fmt::format("{} failed: {}", nvdisasm, text.substr(0, text.find('\n'))));
    }
    return text;
}

}  // namespace pt::cuda
