// Converts a scene in Mitsuba 3 XML into a scene file, as far as scene files can express it. docs/other_renderers.md
// tells how each element is read.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_mitsuba(const ImportSource& source);

// Whether a text looks like Mitsuba XML; for files whose extension names no format.
bool is_like_mitsuba(const std::string& text);

}  // namespace pt
