// What `ptbench new compaction` says of the object that it writes: one serves all bounces of one render, and each
// render has its own.
#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "tests/support/places.h"
#include "variants/registry.h"

namespace pt {
namespace {

int made = 0, calls_of_the_last = 0;

// Leaves ended paths in the queue, as compaction=none does.
class CountedCompaction final : public Compaction {
public:
    CountedCompaction() {
        ++made;
        calls_of_the_last = 0;
    }
    void compact(PathQueue&) override { ++calls_of_the_last; }
};

const Registration registration({.axis = "compaction",
                                 .name = "counted_",
                                 .summary = "counts its objects and their calls",
                                 .origin = "this test",
                                 .traits = CompactionTraits{}},
                                {.compaction = [] { return std::make_unique<CountedCompaction>(); }});

TEST(CompactionObjectTest, EachRenderHasOneForAllItsBounces) {
    const Scene scene = load_scene(test::in_source("scenes/cornell_open.json"));
    RenderRequest request{.variant = Registry::instance().baseline(Backend::cpu), .settings = default_settings(scene)};
    request.variant.set("integrator", "wavefront");
    request.variant.set("compaction", "counted_");
    request.settings.width = request.settings.height = 4;
    request.samples = 2;
    for (int renders = 1; renders <= 3; ++renders) {
        (void)render(scene, request);
        EXPECT_EQ(made, renders);
        EXPECT_GE(calls_of_the_last, 2 * (static_cast<int>(request.settings.depth) - 1));
    }
}

}  // namespace
}  // namespace pt
