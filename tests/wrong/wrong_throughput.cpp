// Scales the throughput of the queue's first path by 1.0001: it shows where one of those paths meets light.
#include "tests/wrong/spoilt.h"

namespace pt::wrong {
namespace {

class WrongThroughput final : public SpoiltCompaction {
    void spoil(PathQueue& queue) override {
        std::visit(
            [&](auto& paths) {
                if (queue.count > 0) {
                    Path<float> path = paths.load(queue.slot(0));
                    path.throughput *= 1.0001f;
                    paths.store(queue.slot(0), path);
                }
            },
            queue.paths);
    }
};

const Registration registration(wrong_compaction("wrong_throughput",
                                                 "the first path in the queue is a little too bright"),
                                {.compaction = [] { return std::make_unique<WrongThroughput>(); }});

}  // namespace
}  // namespace pt::wrong
