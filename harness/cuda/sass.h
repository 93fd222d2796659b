// Counts the machine instructions of compiled kernels by the pipe that executes them. Needs NVIDIA's disassembler
// nvdisasm (of the CUDA toolkit, or the Python package nvidia-cuda-nvdisasm).
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
    // The longest range of code that a backward branch repeats: the loop over a path's segments, if the kernel has one.
    PipeCounts loop;
};

// The pipe that executes an instruction with this mnemonic ("FFMA.FTZ").
std::string pipe_of(const std::string& mnemonic);

// Counts the instructions in the output of `nvdisasm -c`.
std::vector<KernelCode> count_instructions(const std::string& disassembly);

// The path of nvdisasm, from $PTBENCH_NVDISASM, the PATH, the CUDA toolkit, or the Python environment beside the
// program's home; empty if none has it.
std::string find_nvdisasm();

// Disassembles a cubin. Throws MachineError if nvdisasm fails.
std::string disassemble(const std::string& nvdisasm, const std::string& cubin);

}  // namespace pt::cuda
