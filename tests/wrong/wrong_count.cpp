// Returns a count beyond the queue: in queues of over ten thousand paths, or after sixty calls.
#include "tests/wrong/spoilt.h"

namespace pt::wrong {
namespace {

class WrongCount final : public SpoiltCompaction {
    void spoil(PathQueue& queue) override {
        queue.count += queue.count > 10000 || (queue.count > 0 && calls() > 60) ? 14000 : 0;
    }
};

const Registration registration(wrong_compaction("wrong_count", "says that more paths are in play than there are"),
                                {.compaction = [] { return std::make_unique<WrongCount>(); }});

}  // namespace
}  // namespace pt::wrong
