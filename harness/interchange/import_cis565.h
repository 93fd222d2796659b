// Converts a scene in the text format of the CIS 565 path tracers into a scene file. `cis565` is the two student
// projects for that course that ptbench began with.
//
// Rules of the conversion, where loaders of the format differ or its names mislead. (W) marks a warning, with line and
// value: something that the file says is lost, or something that it does not say is added. All else is exact.
// - FOVY is half the vertical field of view, in degrees.
// - ITERATIONS, the sample count, is left out, with a note: samples belong to a run, not to a scene. DEPTH is
//   max_depth.
// - FILE is the scene's name, unless the caller gives one; folders and the extension of a picture are cut off. The
//   camera looks at a point, LOOKAT, or along a direction, VIEW.
// - Comments begin with // or #. These may be left out, and are 0 then: SIGMAA, SIGMAS, VEL, SPECEX, SPECRGB, REFL,
//   REFR, REFRIOR, EMITTANCE, ROUGHNESS, METALLIC, ITERATIONS; TRANS and ROTAT too (W).
// - Students' dialects spell keywords differently and have some that scene files cannot express: course_words.cpp lists
//   them. Such a keyword whose value means off (0, NULL, OFF; FRESNELPOW 5, SPP 1) is ignored. Otherwise it is lost (W)
//   if the scene stays what it is, and a problem for normal, bump and roughness maps, procedural shapes and patterns,
//   and lists of lights. A TEXTURE is the image that replaces the surface's colour, found like a mesh file (W: no
//   dialect says whether its values are sRGB, and which way v goes); on an emitter, glass or a subsurface body it is a
//   problem. An environment map (.hdr, .exr) is the scene's environment, rotated by 90 degrees, as most dialects have
//   it without saying so (W). BACKGROUND_COLOR, in no section, is a constant environment radiance.
// - Objects name a material by the number behind MATERIAL, which counts up from 0; a file that counts otherwise is W.
//   MATERIAL within an object, not behind an empty line, is the object's material.
// - A lens: its radius (LENSRADIUS) and focus distance along the view axis (FOCALDIST), or DOF with both. APERTURE is
//   the diameter in texts, the radius in JSON, and a factor beside a radius (W). Without a focus distance the lens
//   focuses on the point looked at (W). USE_DOF 0 in SETTINGS switches it off.
// - The camera is read as it stands. The course's viewer derives its view from angles that lose signs and lengths where
//   the camera does not look along z: those cameras are noted.
// - A material is the first of these that it fits; its "specular colour" is SPECRGB or, where that is black, RGB (W):
//   EMITTANCE > 0: an emitter of radiance RGB * EMITTANCE, whatever else it says (paths end there in cis565 too);
//   component-wise if EMITTANCE has three numbers, and 1 if a TYPE asks for an emitter without it (W); SIGMAS not 0:
//   subsurface with SIGMAA and SIGMAS, of index REFRIOR (W where REFR is 0), or 1 where that is 0 (W where REFR is
//   not); REFR > 0: a dielectric of index REFRIOR, tinted by the specular colour, absorbing by SIGMAA; with REFL as
//   well it is the course's glass, which is the same; with ROUGHNESS a rough one (W); REFL > 0: a mirror of the
//   specular colour, with ROUGHNESS a rough conductor (W: programs differ in what it means); SPECEX > 0, with REFL and
//   REFR 0: the "imperfect specular" of some dialects, read as a mix: with probability 0.5 a mirror of the specular
//   colour, else diffuse RGB (W: the exponent's value is lost); else: diffuse RGB. A nonzero value that the material
//   has no use for is W, and so is a REFL or REFR that is read as 1. SIGMAS together with REFL or SPECEX cannot be
//   expressed and is a problem. A TYPE (course_type.cpp) stands for REFL or REFR where no line has them; with METALLIC
//   and ROUGHNESS, PBR and the like become glass, metal or a diffuse surface, whichever has the largest share (W).
// - Materials that no object has are kept, with a note.
// - Rotation is the matrix Rx Ry Rz, z first; scene files turn about x first, so angles about several axes change. The
//   matrix is the same to rounding.
// - Where an object has a VEL, the shutter is open from 0 to 1 with the density "late" (W): the project of cis565 with
//   motion blur draws its times as the square root of a uniform number. With ANIMET, a velocity before the object's own
//   transform, TRANS_DST, where TRANS ends, or T_MOTION, how far it goes, the density is "uniform" (W). Shapes that
//   turn or grow do not (W).
// - An object has one shape: a mesh beside a cube, a sphere or a rect, or behind all objects, is lost (W).
// - A mesh is FILE, or a file's name on a line of its own, found as course_mesh.h has it; its normals are not read.
//   With the material -1 it has those of its own file, an object for each: import_mtl.h.
// - rect is a square of side 1 in the plane z = 0.
#pragma once

#include <string>

#include "harness/interchange/import_result.h"
#include "harness/scene/scene.h"

namespace pt {

// Problems are keywords that the text format does not know, and content that scene files do not allow. `file` is the
// path of the source in messages; `name`, if not empty, is the scene's name in place of the one from the line FILE.
ImportResult import_cis565_scene(const std::string& text, const std::string& file, const std::string& name = "");
ImportResult import_cis565(const ImportSource& source);

// Converts angles of a rotation Rx Ry Rz to angles of Rz Ry Rx (rotation_of). A rotation about one axis keeps its own.
Vec3d rotation_x_first(const Vec3d& degrees);

}  // namespace pt
