// A comparison in the result file: a cell, the baseline of its study, the ratio of their times and the verdict. The
// pages that analysis/ draws show these verdicts.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "harness/fields.h"

namespace pt {

struct ComparisonFacts {
    std::string study = {}, cell = {};
    std::optional<std::string> baseline = {};            // name of the baseline cell; null if there is none
    std::optional<double> ratio = {};                    // ratio of median times per spp; below 1 the cell is faster
    std::optional<std::array<double, 2>> interval = {};  // confidence interval of the ratio of times
    std::optional<std::string> word = {};                // verdict on the ratio; null if there is no ratio
    std::string reason_code = {};                        // why the verdict is UNSURE or null, or ""
    std::optional<std::string> in_time = {}, in_cycles = {};  // verdicts on times alone and on clock cycles alone

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("study", self.study);
        visit("cell", self.cell);
        visit.or_null("baseline", self.baseline);
        visit.or_null("ratio", self.ratio);
        visit.or_null("interval", self.interval);
        visit.or_null("word", self.word);
        visit("reason_code", self.reason_code);
        visit.or_null("in_time", self.in_time);
        visit.or_null("in_cycles", self.in_cycles);
    }
};

}  // namespace pt
