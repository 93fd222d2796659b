// --backend and --tune as they are read from a command line.
#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/cli/commands.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "tests/support/backends.h"

namespace pt {
namespace {

template <class Error, class Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(BackendArgumentTest, IsCudaWhereItIsAvailableUnlessItIsNamed) {
    EXPECT_EQ(parse_backend("cpu"), Backend::cpu);
    EXPECT_EQ(parse_backend(""), cuda::not_available().empty() ? Backend::cuda : Backend::cpu);
    if (test::cuda_is_built()) {
        EXPECT_EQ(parse_backend("cuda"), Backend::cuda);  // cells can be listed without a device
    }
}

TEST(BackendArgumentTest, RefusesOtherNames) {
    for (const std::string text : {"gpu", "CUDA", "cpu ", "cpu,cuda", "c"}) {
        EXPECT_EQ(refusal<InputError>([&] { parse_backend(text); }),
                  "--backend: argument: found \"" + text + "\", allowed: cpu, cuda");
    }
}

TEST(BackendArgumentTest, ABackendThatIsNotAvailableIsTheMachinesFaultAndSaysWhy) {
    EXPECT_NO_THROW(require_backend(Backend::cpu));
    const std::string reason = cuda::not_available();
    const std::string expected = reason.empty() ? "" : "cuda: not available (" + reason + ")";
    EXPECT_EQ(refusal<MachineError>([] { require_backend(Backend::cuda); }), expected);
    if (!test::cuda_is_built()) {
        EXPECT_FALSE(reason.empty());
        EXPECT_EQ(refusal<MachineError>([] { parse_backend("cuda"); }), expected);
    }
}

TEST(TuneArgumentTest, ListsValues) {
    TunableValues tunables;
    add_tunable_argument(tunables, "jitters=4,16,1");
    EXPECT_EQ(tunables, (TunableValues{{"jitters", {4, 16, 1}}}));
    EXPECT_EQ(refusal<InputError>([&] { add_tunable_argument(tunables, "jitters=4096"); }),
              "--tune: argument: found jitters twice, allowed: once, with commas between its values");
}

TEST(TuneArgumentTest, RefusesWhatIsWrong) {
    const std::string form = "allowed: NAME=VALUE or NAME=VALUE,VALUE";
    const std::pair<std::string, std::string> cases[] = {
        {"", "argument: found \"\", " + form},
        {"jitters", "argument: found \"jitters\", " + form},
        {"=4", "argument: found \"=4\", " + form},
        {"jitters=", "argument: found \"jitters=\", " + form},
        {"colour=4", "argument.colour: found tunable \"colour\", allowed: " + test::tunable_names()},
        {"jitters=0", "argument.jitters: found 0, allowed: a whole number from 1 to 4096"},
        {"jitters=4,4097", "argument.jitters: found 4097, allowed: a whole number from 1 to 4096"},
        {"jitters=4,8,4", "argument.jitters: found 4 twice, allowed: once"},
    };
    TunableValues tunables{{"jitters", {2}}};
    const TunableValues before = tunables;
    for (const auto& [argument, message] : cases) {
        EXPECT_EQ(refusal<InputError>([&, text = argument] { add_tunable_argument(tunables, text); }),
                  "--tune: " + message);
    }
    for (const std::string value : {"four", "4,", ",4", "4,,8", "4;8", "4.5", "-4", "+4", " 4", "4 ", "0x4", "1e3",
                                    "4294967296", "99999999999999999999"}) {
        EXPECT_EQ(refusal<InputError>([&] { add_tunable_argument(tunables, "jitters=" + value); }),
                  "--tune: argument.jitters: found \"jitters=" + value + "\", allowed: whole numbers, comma-separated");
    }
    EXPECT_EQ(tunables, before);
}

TEST(TuneArgumentTest, AValueIsAllowedIfSomeChoiceAllowsIt) {
    if (!test::cuda_is_built()) {
        GTEST_SKIP() << "built without a CUDA toolkit";
    }
    TunableValues tunables;
    add_tunable_argument(tunables, "spp_in_flight=1024");  // a megakernel's, not a wavefront's
    add_tunable_argument(tunables, "block=32,1024");
    EXPECT_EQ(tunables, (TunableValues{{"block", {32, 1024}}, {"spp_in_flight", {1024}}}));
    EXPECT_EQ(refusal<InputError>([&] { add_tunable_argument(tunables, "spp_in_flight=1048577"); }),
              "--tune: argument.spp_in_flight: found 1048577, allowed: a whole number from 1 to 1048576, or a whole "
              "number from 1 to 256");
    EXPECT_EQ(refusal<InputError>([&] { add_tunable_argument(tunables, "block=48"); }),
              "--tune: argument.block: found 48, allowed: a whole number from 32 to 1024, a multiple of 32");
}

}  // namespace
}  // namespace pt
