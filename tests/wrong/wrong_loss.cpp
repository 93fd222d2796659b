// Drops the last live path from its 61st call on: a short render is right, and a path that met no more light is no loss
// to the film.
#include "tests/wrong/spoilt.h"

namespace pt::wrong {
namespace {

class WrongLoss final : public SpoiltCompaction {
    void spoil(PathQueue& queue) override { queue.count -= calls() > 60 && queue.count > 0 ? 1 : 0; }
};

const Registration registration(wrong_compaction("wrong_loss", "the last live path is lost after 60 calls"),
                                {.compaction = [] { return std::make_unique<WrongLoss>(); }});

}  // namespace
}  // namespace pt::wrong
