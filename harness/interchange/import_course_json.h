// Turns a scene in the JSON format that the path tracers of CIS 565 read since 2023 into a scene file: "Materials" by
// name, "Camera", "Objects". Its members mean what the lines of the text format mean, so import_cis565.h has the
// readings; this is what is JSON's own:
// - A material's TYPE says what it is; keys of the text (REFL, REFRIOR, ..) count in any TYPE. A glass without an index
//   has 1.5 (W).
// - What the course's loader does with names that are not there is done here (W): an object whose MATERIAL is none of
//   "Materials" has the first of them by name, and a TYPE that names a material and is no type makes a black one.
// - A mesh without a MATERIAL has those of its own file.
// - TRANS, ROTAT and SCALE may be missing, and are neutral then; FILE may be, and is the file's own name then.
// - What is beside "Materials", "Camera" and "Objects" is a light or a mesh of a dialect's own: a problem. "Meshes" are
//   names for files, which objects call by them; an environment map is the camera's ENVIRONMENT.
// - A line of a message is the member's, and its first word is the member's path.
#pragma once

#include "harness/interchange/import_result.h"

namespace pt {

ImportResult import_course_json(const ImportSource& source);

// Whether a text is like JSON.
bool is_like_json(const std::string& text);

}  // namespace pt
