// What the compiler and the disassembler say of kernels, read from their own words.
#include "harness/cuda/sass.h"

#include <array>

#include <gtest/gtest.h>

#include "variants/cuda/runtime/compiler_report.h"

namespace pt {
namespace {

using cuda::PipeCounts;

// --- ptxas's log
// ------------------------------------------------------------------------------------------------------

std::array<int, 5> numbers(const cuda::KernelReport& kernel) {
    return {kernel.registers, kernel.stack_bytes, kernel.spill_store_bytes, kernel.spill_load_bytes,
            kernel.shared_bytes};
}

TEST(PtxasLogTest, HasEveryKernelWithItsOwnNumbers) {
    const std::vector<cuda::KernelReport> kernels = cuda::parse_ptxas_log(
        R"(ptxas info    : 905 bytes gmem, 32768 bytes cmem[3]
ptxas info    : Compiling entry function 'megakernel' for 'sm_90'
ptxas info    : Function properties for megakernel
ptxas         .     40 bytes stack frame, 8 bytes spill stores, 12 bytes spill loads
ptxas info    : Used 56 registers, used 1 barriers, 40 bytes cumulative stack size, 20 bytes smem, 816 bytes cmem[0]
ptxas info    : Compile time = 133.773 ms
ptxas info    : Compiling entry function 'fill_cache' for 'sm_90'
ptxas info    : Function properties for fill_cache
    128 bytes stack frame, 256 bytes spill stores, 512 bytes spill loads
ptxas info    : Used 255 registers, used 0 barriers, 49152 bytes smem
)");
    ASSERT_EQ(kernels.size(), 2u);
    EXPECT_EQ(kernels[0].name, "megakernel");
    EXPECT_EQ(numbers(kernels[0]), (std::array{56, 40, 8, 12, 20}));
    EXPECT_EQ(kernels[1].name, "fill_cache");
    EXPECT_EQ(numbers(kernels[1]), (std::array{255, 128, 256, 512, 49152}));
}

TEST(PtxasLogTest, AKernelWithoutSharedMemoryHasNone) {
    const std::vector<cuda::KernelReport> kernels = cuda::parse_ptxas_log(
        R"(ptxas info    : Compiling entry function 'with' for 'sm_75'
ptxas info    : Used 16 registers, used 1 barriers, 20 bytes smem
ptxas info    : Compiling entry function 'without' for 'sm_75'
ptxas         .     0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 8 registers, used 0 barriers, 360 bytes cmem[0]
)");
    ASSERT_EQ(kernels.size(), 2u);
    EXPECT_EQ(numbers(kernels[0]), (std::array{16, 0, 0, 0, 20}));
    EXPECT_EQ(kernels[1].name, "without");
    EXPECT_EQ(numbers(kernels[1]), (std::array{8, 0, 0, 0, 0}));
}

// ptxas speaks of a function that was not inlined after the kernel that calls it: the generic megakernel has one.
TEST(PtxasLogTest, AFunctionThatIsCalledIsNotTheKernel) {
    const std::vector<cuda::KernelReport> kernels = cuda::parse_ptxas_log(
        R"(ptxas info    : Compiling entry function 'megakernel' for 'sm_90'
ptxas info    : Function properties for megakernel
ptxas         .     904 bytes stack frame, 8 bytes spill stores, 12 bytes spill loads
ptxas info    : Used 127 registers, used 1 barriers, 904 bytes cumulative stack size, 20 bytes smem
ptxas info    : Compile time = 4207.988 ms
ptxas info    : Function properties for _ZN2pt5shadeEv
ptxas         .     0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
)");
    ASSERT_EQ(kernels.size(), 1u);
    EXPECT_EQ(numbers(kernels[0]), (std::array{127, 904, 8, 12, 20}));
}

TEST(PtxasLogTest, SaysNothingOfNoKernel) {
    EXPECT_TRUE(cuda::parse_ptxas_log("").empty());
    EXPECT_TRUE(cuda::parse_ptxas_log("ptxas info    : 0 bytes gmem\n"
                                      "ptxas info    : Used 16 registers, used 1 barriers, 20 bytes smem\n"
                                      "    8 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads\n")
                    .empty());
}

// --- pipes
// ------------------------------------------------------------------------------------------------------------

TEST(PipeTest, AMnemonicHasOne) {
    const std::pair<const char*, std::vector<const char*>> pipes[] = {
        {"fma", {"FFMA", "FFMA.FTZ", "FMUL", "FADD.FTZ", "IMAD", "IMAD.WIDE.U32", "IMAD.MOV.U32", "HFMA2.MMA"}},
        {"alu",
         {"LOP3.LUT", "FSETP.GT.AND", "ISETP.NE.U32.AND", "FMNMX", "SEL", "FSEL", "SHF.R.U32.HI", "IADD3", "LEA", "MOV",
          "PRMT", "PLOP3.LUT", "VIADD"}},
        {"xu", {"MUFU.RCP", "MUFU.RSQ", "I2F.U32", "F2I.TRUNC.NTZ", "F2F.F64.F32", "POPC", "FLO.U32", "BREV"}},
        {"fp64", {"DADD", "DMUL", "DFMA", "DSETP.GEU.AND"}},
        {"lsu",
         {"LDG.E.128", "LDC.64", "LDS", "LDL", "LD.E", "STG.E", "STS", "STL.128", "ST.E", "ATOMG.E.ADD", "ATOMS.ADD",
          "ATOM.E.ADD.64", "RED.E.ADD", "REDG.E.ADD.64", "SHFL.BFLY", "VOTE.ANY", "MATCH.ANY", "BAR.SYNC",
          "MEMBAR.GPU"}},
        {"control",
         {"BRA", "BRA.U", "BRX", "BSSY", "BSYNC", "BREAK", "CALL.REL.NOINC", "RET.REL.NODEC", "EXIT", "NOP", "YIELD",
          "WARPSYNC", "BMOV.32.CLEAR"}},
        {"uniform", {"UIADD3", "UMOV", "ULDC.64", "UIMAD", "ULEA", "UPOPC", "R2UR"}},
    };
    for (const auto& [pipe, mnemonics] : pipes) {
        for (const char* mnemonic : mnemonics) {
            EXPECT_EQ(cuda::pipe_of(mnemonic), pipe) << mnemonic;
        }
    }
}

// --- disassembly
// ------------------------------------------------------------------------------------------------------

const cuda::KernelCode& only(const std::vector<cuda::KernelCode>& kernels) {
    if (kernels.size() != 1) {
        throw std::runtime_error("not one kernel");
    }
    return kernels[0];
}

TEST(DisassemblyTest, KernelsAreCountedApart) {
    const std::vector<cuda::KernelCode> kernels = cuda::count_instructions(R"(
	.target	sm_90
//--------------------- .text.first                --------------------------
	.section	.text.first,"ax",@progbits
        .global         first
        .type           first,@function
first:
.text.first:
        /*0000*/                   LDC R1, c[0x0][0x28] ;
        /*0010*/                   LOP3.LUT P1, RZ, R7, 0x7fffffff, RZ, 0xc0, !PT ;
        /*0020*/              @!P0 BRA `(.L_x_2) ;
.L_x_1:
        /*0030*/                   FFMA R2, R2.reuse, R3, R4 ;
        /*0040*/                   MUFU.RCP R5, R2 ;
        /*0050*/              @!PT ISETP.GT.AND P1, PT, R5, RZ, PT ;
        /*0060*/               @P1 BRA `(.L_x_1) ;
.L_x_2:
        /*0d40*/              @UP0 UIADD3 UR4, UR4, 0x1, URZ ;
        /*0d50*/         @!UP0 UMOV UR5, URZ ;
        /*10d60*/                  STG.E desc[UR4][R2.64], R5 ;
        /*10d70*/                  EXIT ;
//--------------------- .text.second               --------------------------
.text.second:
        /*0000*/                   DFMA R2, R2, R4, R6 ;
.L_x_1:
        /*0010*/                   FADD R2, R2, R3 ;
        /*0020*/                   BRA.U `(.L_x_1) ;
)");
    ASSERT_EQ(kernels.size(), 2u);
    EXPECT_EQ(kernels[0].name, "first");
    EXPECT_EQ(kernels[0].all,
              (PipeCounts{{"lsu", 2}, {"alu", 2}, {"control", 3}, {"fma", 1}, {"xu", 1}, {"uniform", 2}}));
    EXPECT_EQ(kernels[0].loop, (PipeCounts{{"fma", 1}, {"xu", 1}, {"alu", 1}, {"control", 1}}));
    EXPECT_EQ(kernels[1].name, "second");
    EXPECT_EQ(kernels[1].all, (PipeCounts{{"fp64", 1}, {"fma", 1}, {"control", 1}}));
    EXPECT_EQ(kernels[1].loop, (PipeCounts{{"fma", 1}, {"control", 1}}));
}

TEST(DisassemblyTest, TheOuterLoopIsTheLoop) {
    const cuda::KernelCode kernel = only(cuda::count_instructions(R"(
.text.nested:
        /*0000*/                   MOV R1, RZ ;
.L_x_0:
        /*0010*/                   FADD R2, R2, R3 ;
.L_x_1:
        /*0020*/                   MUFU.RCP R5, R2 ;
        /*0030*/               @P1 BRA `(.L_x_1) ;
        /*0040*/               @P0 BRA `(.L_x_0) ;
        /*0050*/                   EXIT ;
)"));
    EXPECT_EQ(kernel.loop, (PipeCounts{{"fma", 1}, {"xu", 1}, {"control", 2}}));
}

TEST(DisassemblyTest, OfTwoLoopsTheLongerCountsWhicheverComesFirst) {
    const std::string short_loop = R"(
.L_x_0:
        /*0010*/                   FADD R2, R2, R3 ;
        /*0030*/               @P1 BRA `(.L_x_0) ;
)";
    // The long loop has no more than one instruction more.
    const std::string long_loop = R"(
.L_x_1:
        /*0040*/                   MUFU.RCP R5, R2 ;
        /*0050*/                   MUFU.RCP R5, R2 ;
        /*0060*/               @P1 BRA `(.L_x_1) ;
)";
    const PipeCounts expected{{"xu", 2}, {"control", 1}};
    EXPECT_EQ(only(cuda::count_instructions(".text.a:\n" + long_loop + short_loop)).loop, expected);
    EXPECT_EQ(only(cuda::count_instructions(".text.a:\n" + short_loop + long_loop)).loop, expected);
}

TEST(DisassemblyTest, ABranchForwardIsNoLoop) {
    const cuda::KernelCode kernel = only(cuda::count_instructions(R"(
.text.forward:
        /*0000*/               @P0 BRA `(.L_x_0) ;
        /*0010*/                   FADD R2, R2, R3 ;
.L_x_0:
        /*0020*/                   CALL.REL.NOINC `($forward$slow) ;
        /*0030*/                   EXIT ;
)"));
    EXPECT_EQ(kernel.all, (PipeCounts{{"fma", 1}, {"control", 3}}));
    EXPECT_EQ(kernel.loop, PipeCounts{});
}

// The compiler ends every kernel with a branch to itself, which nothing reaches.
TEST(DisassemblyTest, TheTrapBehindTheCodeIsNoLoop) {
    const cuda::KernelCode kernel = only(cuda::count_instructions(R"(
.text.straight:
        /*0000*/                   FADD R2, R2, R3 ;
        /*0010*/                   EXIT ;
.L_x_0:
        /*0020*/                   BRA `(.L_x_0);
        /*0030*/                   NOP;
)"));
    EXPECT_EQ(kernel.loop, PipeCounts{});
}

TEST(DisassemblyTest, WithoutAKernelThereIsNothing) {
    EXPECT_TRUE(cuda::count_instructions("").empty());
    EXPECT_TRUE(cuda::count_instructions("        /*0000*/                   EXIT ;\n").empty());
}

}  // namespace
}  // namespace pt
