// Writes where nothing is, in the render of the process whose number stands in the environment.
#include <cstdlib>

#include "tests/wrong/spoilt.h"

namespace pt::wrong {
namespace {

int renders = 0;

class WrongCrash final : public SpoiltCompaction {
public:
    WrongCrash() { renders += 1; }

private:
    void spoil(PathQueue&) override {
        const char* const in = std::getenv("PTBENCH_CRASH_IN_RENDER");
        if (in != nullptr && renders == std::atoi(in)) {
            int* volatile nowhere = nullptr;
            *nowhere = 1;
        }
    }
};

const Registration registration(wrong_compaction("wrong_crash", "writes through a null pointer"),
                                {.compaction = [] { return std::make_unique<WrongCrash>(); }});

}  // namespace
}  // namespace pt::wrong
