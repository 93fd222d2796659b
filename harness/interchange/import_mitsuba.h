// Turns a scene in Mitsuba 3's XML into a scene file: the part of that format that scene files have. What is read how
// is in docs/other_renderers.md.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_mitsuba(const ImportSource& source);

// Whether a text that no file ending tells of may be one.
bool is_like_mitsuba(const std::string& text);

}  // namespace pt
