// Compactions that are wrong in a known way, for a program beside ptbench (tests/CMakeLists.txt): what runs, verifies
// and crashes there has to be named, and nobody else. They work like thrust_remove_if and then spoil what it left.
#pragma once

#include <memory>

#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt::wrong {

class SpoiltCompaction : public Compaction {
public:
    void compact(PathQueue& queue) final {
        calls_ += 1;
        original_->compact(queue);
        spoil(queue);
    }

protected:
    virtual void spoil(PathQueue& queue) = 0;
    int calls() const { return calls_; }  // in this render, this one included

private:
    std::unique_ptr<Compaction> original_ =
        Registry::instance().find("compaction", "thrust_remove_if")->hook.compaction();
    int calls_ = 0;
};

constexpr Descriptor wrong_compaction(std::string_view name, std::string_view summary) {
    return {.axis = "compaction",
            .name = name,
            .summary = summary,
            .origin = "tests/wrong",
            .check_counters = compacted_every_bounce};
}

}  // namespace pt::wrong
