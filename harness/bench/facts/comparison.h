// A comparison of the result file: a cell against the baseline of its study, with the ratio of their times and the
// verdict. Python's pages say what stands here.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "harness/fields.h"

namespace pt {

struct ComparisonFacts {
    std::string study = {}, cell = {};
    std::optional<std::string> baseline = {};                 // its cell; null: there is none
    std::optional<double> ratio = {};                         // of median times a spp: below 1 the cell is faster
    std::optional<std::array<double, 2>> interval = {};       // of the ratio, by the samples of this run
    std::optional<std::string> word = {};                     // null: there is no ratio
    std::string reason_code = {};                             // why the word is UNSURE or null; else empty
    std::optional<std::string> in_time = {}, in_cycles = {};  // the words on times and on cycles alone

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
