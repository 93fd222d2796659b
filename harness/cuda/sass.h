// The machine code of compiled kernels, counted by the pipe that executes it. Needs NVIDIA's disassembler, nvdisasm (of
// the CUDA toolkit, or the Python package nvidia-cuda-nvdisasm).
#pragma once

#include <map>
#include <string>
#include <vector>

namespace pt::cuda {

// Number of instructions by pipe: "fma" (multiply, add, integer multiply-add), "alu" (compare, select, logic, integer
// add), "xu" (reciprocal, root, conversion), "fp64", "lsu" (memory, shuffles, votes), "uniform", "control". The groups
// follow Nsight Compute's.
using PipeCounts = std::map<std::string, std::size_t>;

struct KernelCode {
    std::string name;
    PipeCounts all;
    // The longest stretch that a branch leads back over: the loop over a path's segments, where the kernel has one.
    PipeCounts loop;
};

// The pipe of an instruction by its mnemonic ("FFMA.FTZ").
std::string pipe_of(const std::string& mnemonic);

// Counts the instructions in nvdisasm's text (`nvdisasm -c`).
std::vector<KernelCode> count_instructions(const std::string& disassembly);

// The path of nvdisasm, from $PTBENCH_NVDISASM, the PATH, the toolkit, or the Python environment beside the program's
// home; empty: it is in none of them.
std::string find_nvdisasm();

// Disassembles a cubin. Throws MachineError if nvdisasm fails.
std::string disassemble(const std::string& nvdisasm, const std::string& cubin);

}  // namespace pt::cuda
