// Converts a scene in the JSON format that the path tracers of CIS 565 read since 2023 into a scene file: "Materials"
// by name, "Camera", "Objects". Its members mean what the lines of the text format mean (import_cis565.h); these rules
// are for JSON alone, with (W) for a warning:
// - A material's TYPE decides its kind; keys of the text format (REFL, REFRIOR, ..) count in any TYPE. Glass without an
//   index has 1.5 (W).
// - Unknown names are resolved as the course's loader does (W): an object whose MATERIAL is not in "Materials" has the
//   first of them by name, and a TYPE that is no type but the name of a material makes a black material.
// - A mesh without a MATERIAL has the materials of its own file.
// - A missing TRANS, ROTAT or SCALE is neutral; a missing FILE stands for the name of the scene's source file.
// - Other top-level members are lights or meshes of a dialect and a problem, except "Meshes", which names mesh files
//   for objects; an environment map is the camera's ENVIRONMENT.
// - Messages give the line of a member, and the member's path as its first word.
#pragma once

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_course_json(const ImportSource& source);

// Whether a text looks like JSON, by its beginning.
bool is_like_json(const std::string& text);

}  // namespace pt
