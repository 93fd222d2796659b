// Turns a scene in Mitsuba 3's XML into a scene file: the part of that format that scene files have. What is read how
// is in docs/other_renderers.md.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_mitsuba(const ImportSource& source);

// Whether a text may be Mitsuba's XML, for a file whose ending tells nothing.
bool is_like_mitsuba(const std::string& text);

}  // namespace pt
