// Scales the throughput of the queue's first path by 1.0001, in all calls but the first eight: a short render is right,
// and of others those in which that path meets no light. So it goes wrong in some samples and not in others.
#include "tests/wrong/spoilt.h"

namespace pt::wrong {
namespace {

class WrongThroughput final : public SpoiltCompaction {
    void spoil(PathQueue& queue) override {
        std::visit(
            [&](auto& paths) {
                if (queue.count > 0 && calls() > 8) {
                    Path<float> path = paths.load(queue.slot(0));
                    path.throughput *= 1.0001f;
                    paths.store(queue.slot(0), path);
                }
            },
            queue.paths);
    }
};

const Registration registration(wrong_compaction("wrong_throughput", "the first path is a little too bright"),
                                {.compaction = [] { return std::make_unique<WrongThroughput>(); }});

}  // namespace
}  // namespace pt::wrong
