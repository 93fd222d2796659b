// What a render says of its kernels where another one of this process compiled them: a summary that says "from the
// cache, in no time" of kernels that took half a minute is a wrong number.
#include <gtest/gtest.h>

#include "harness/render/renderer.h"

namespace pt {
namespace {

CudaFacts facts(double seconds, bool from_cache) {
    CudaFacts made;
    made.compile_seconds = seconds;
    made.from_cache = from_cache;
    return made;
}

TEST(CudaFacts, SayWhatAnEarlierRenderCompiled) {
    CudaFacts loaded = facts(0, true);
    loaded.add_compilation(facts(25, false));
    EXPECT_EQ(loaded.compile_seconds, 25);
    EXPECT_FALSE(loaded.from_cache);

    CudaFacts compiled = facts(3, false);
    compiled.add_compilation(facts(0, true));
    EXPECT_EQ(compiled.compile_seconds, 3);
    EXPECT_FALSE(compiled.from_cache);

    CudaFacts cached = facts(0.5, true);
    cached.add_compilation(facts(0.25, true));
    EXPECT_EQ(cached.compile_seconds, 0.75);
    EXPECT_TRUE(cached.from_cache);
}

}  // namespace
}  // namespace pt
