// No compaction: ended paths stay in the queue, and every stage passes over them.
#include "variants/registry.h"

namespace pt::compaction::none {
namespace {

class None final : public Compaction {
public:
    void compact(PathQueue&) override {}
    bool is_active() const override { return false; }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "none",
        .summary = "ended paths stay where they are and are passed over",
        .origin = "cis565, compaction off",
        .baseline = on_every_backend,
        .traits = CompactionTraits{.compacts = false},
        .backends = on_every_backend,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.compactions == 0 ? "" : "a compaction ran";
        },
    },
    {.compaction = [] { return std::make_unique<None>(); }});

}  // namespace
}  // namespace pt::compaction::none
