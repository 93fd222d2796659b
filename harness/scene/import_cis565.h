// Turns a scene in the text format of the CIS 565 path tracers into a scene file. `cis565` is the two student projects
// for that course that ptbench began with.
//
// How the format is read, where its loaders differ or its names mislead. What loses something that the file says, or
// adds something that it does not, is a warning with line and value (W below); the rest is exact.
// - FOVY is half the vertical field of view, in degrees.
// - ITERATIONS, the sample count, is left out, with a note: samples belong to a run, not to a scene. DEPTH is
// max_depth.
// - FILE is the scene's name, where the call gives none. The view goes to a point, LOOKAT, or along a direction, VIEW.
// - Lines that start with // are comments. These may be left out, and are 0 then: SIGMAA, SIGMAS, VEL, SPECEX, SPECRGB,
//   REFL, REFR, REFRIOR, EMITTANCE, ITERATIONS.
// - A material is the first of these that it fits; "specular colour" is SPECRGB or, where that is black, RGB (W):
//   EMITTANCE > 0: an emitter of radiance RGB * EMITTANCE, whatever else it says (paths end there in cis565 too);
//   SIGMAS not 0: subsurface with SIGMAA and SIGMAS, of index REFRIOR (W where REFR is 0), or 1 where that is 0 (W
//   where REFR is not); REFR > 0: a dielectric of index REFRIOR, tinted by the specular colour, absorbing by SIGMAA;
//   REFL > 0: a mirror of the specular colour;
//   SPECEX > 0, with REFL and REFR 0: the "imperfect specular" of some dialects, read as a mix: with probability 0.5 a
//   mirror of the specular colour, else diffuse RGB. The exponent's size means nothing more (W);
//   else: diffuse RGB.
//   A value that is not 0 and that the material has no use for is W, and so is a REFL or REFR that is read as 1.
//   REFL and REFR above 0 in one material, and SIGMAS together with REFL or SPECEX, cannot be expressed and are errors.
// - Materials that no object has are kept, with a note.
// - Rotation is the matrix Rx Ry Rz, z first; scene files turn about x first, so angles about several axes change. The
//   matrix is the same to rounding.
// - Where an object has a velocity, the shutter is open from 0 to 1 with the density "late" (W): the project of cis565
//   with motion blur draws its times as the square root of a uniform number.
#pragma once

#include <string>

#include "harness/scene/import_result.h"
#include "harness/scene/scene.h"

namespace pt {

// Problems are all that the format does not know, and all that it knows but scene files do not allow. `file` is for the
// description; a `name` that is not empty becomes the scene's, and FILE may say what it likes.
ImportResult import_cis565_scene(const std::string& text, const std::string& file, const std::string& name = "");

// The angles for rotation_of that give the matrix Rx Ry Rz of `degrees`. Angles about a single axis stay as they are.
Vec3d rotation_x_first(const Vec3d& degrees);

}  // namespace pt
