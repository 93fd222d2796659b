// No sorting: paths are shaded in the order in which they lie.
#include "variants/registry.h"

namespace pt::sorting::none {
namespace {

class None final : public Sorting {
public:
    void sort(PathQueue&, std::uint32_t) override {}
    bool is_active() const override { return false; }
};

const Registration registration(
    {
        .axis = "sorting",
        .name = "none",
        .summary = "paths are shaded in the order in which they lie",
        .origin = "cis565, sorting off",
        .baseline = on_every_backend,
        .traits = SortingTraits{.sorts = false},
        .backends = on_every_backend,
        .check_counters = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.sorts == 0 ? "" : "a sort ran";
        },
    },
    {.sorting = [] { return std::make_unique<None>(); }});

}  // namespace
}  // namespace pt::sorting::none
