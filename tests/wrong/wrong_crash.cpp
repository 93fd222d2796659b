// Writes where nothing is, in the render of the process whose number stands in the environment.
#include <cstdlib>

#include "tests/wrong/spoilt.h"
#include "variants/cpu/parallel_for.h"

namespace pt::wrong {
namespace {

int renders = 0;

class WrongCrash final : public SpoiltCompaction {
public:
    WrongCrash() { renders += 1; }

private:
    void spoil(PathQueue& queue) override {
        const char* const in = std::getenv("PTBENCH_CRASH_IN_RENDER");
        if (in != nullptr && renders == std::atoi(in)) {
            // The crash is on whichever thread of the pool comes first.
            parallel_for(queue.count, 64, [](std::size_t, std::size_t) {
                volatile int* volatile nowhere = nullptr;
                *nowhere = 1;
            });
        }
    }
};

const Registration registration(wrong_compaction("wrong_crash", "writes through a null pointer"),
                                {.compaction = [] { return std::make_unique<WrongCrash>(); }});

}  // namespace
}  // namespace pt::wrong
