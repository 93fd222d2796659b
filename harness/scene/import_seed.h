// Turns a scene in the text format of the CIS 565 path tracers, ptbench's two seeds among them, into a scene file.
//
// How the format is read, where its loaders differ or its names mislead:
// - FOVY is half the vertical field of view, in degrees.
// - ITERATIONS, the sample count, is ignored: samples belong to a run, not to a scene. DEPTH is max_depth.
// - FILE is the scene's name. The view goes to a point, LOOKAT, or along a direction, VIEW.
// - Lines that start with // are comments. These may be left out, and are 0 then: SIGMAA, SIGMAS, VEL, SPECEX, SPECRGB,
//   REFL, REFR, REFRIOR, EMITTANCE, ITERATIONS.
// - A material is the first of these that it fits; "specular colour" is SPECRGB or, where that is black, RGB:
//   EMITTANCE > 0: an emitter of radiance RGB * EMITTANCE, whatever else it says (paths end there in the seeds too);
//   SIGMAS not 0: subsurface with SIGMAA and SIGMAS, of index REFRIOR, or 1 where that is 0;
//   REFR > 0: a dielectric of index REFRIOR, tinted by the specular colour, absorbing by SIGMAA;
//   REFL > 0: a mirror of the specular colour;
//   SPECEX > 0, with REFL and REFR 0: the "imperfect specular" of some dialects, read as a mix: with probability 0.5 a
//   mirror of the specular colour, else diffuse RGB. The exponent's size means nothing more;
//   else: diffuse RGB.
//   REFL and REFR above 0 in one material, and SIGMAS together with REFL or SPECEX, cannot be expressed and are errors.
// - Rotation is the matrix Rx Ry Rz, z first; scene files turn about x first, so angles about several axes change.
// - Where an object has a velocity, the shutter is open from 0 to 1 with the density "late": the seed with motion blur
//   draws its times as the square root of a uniform number.
#pragma once

#include <string>

#include "harness/scene/scene.h"

namespace pt {

// The scene file's text. Throws InputError with file and line for what the format does not know, and for what it knows
// but scene files do not allow.
std::string import_seed_scene(const std::string& text, const std::string& file);

// The angles for rotation_of that give the matrix Rx Ry Rz of `degrees`. Angles about a single axis stay as they are.
Vec3d rotation_x_first(const Vec3d& degrees);

}  // namespace pt
