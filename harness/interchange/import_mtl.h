// Imports the materials of an OBJ mesh's own file: those that it names by usemtl and that its MTL library defines. Each
// becomes a material of the scene, and the triangles that have it become an object.
//
// Rules of reading an MTL library, where (W) marks a warning about something that scene files cannot express:
// - Ke not 0: an emitter of that radiance; paths end there, so Kd is not used (W).
// - illum 4, 6, 7 and 9: glass of index Ni (1.5 without it: W), tinted by Tf; Kd is not used (W).
// - illum 3, 5 and 8, with a Ks: a mix of diffuse Kd and mirror Ks with probabilities in proportion to the two, so that
//   their sum is exact where it is at most 1, and scaled down to 1 otherwise (W); without a Kd a mirror. The Fresnel
//   term of illum 5 is lost (W). A map_Kd is shown without the mirror (W).
// - Otherwise diffuse, with Kd or the image of map_Kd (W, as for TEXTURE in import_cis565.h; a Kd beside it other than
//   white is W too). Ks, highlights of lamps, is lost (W). illum 0, without shading, is read as 1 (W).
// - Ka, Ns and sharpness mean nothing to paths. Maps of Ks and Ns, and the keys of metals and coats (Pr, Pm, Ps, Pc,
//   aniso), are lost (W). d below 1 or Tr above 0 on a material that is not glass, maps of normals, bumps,
//   displacement, opacity and emission, and unknown keys are problems.
// - Names go to the line's end; if no material has the name, a # behind a space begins a comment (W). Of two materials
//   of one name the first is used, of two lines of one key the last (W, where they differ).
// - Faces whose material is in no library take the material that is named like their group (W), as one dialect means.
#pragma once

#include <filesystem>

#include "harness/interchange/course_scene.h"
#include "harness/mesh/obj_materials.h"

namespace pt {

// Makes a mesh, with the materials of its own file, into one object per material. Returns none, after reporting it, if
// there are problems. `at`: the line of the scene that names the mesh.
std::vector<OwnPart> import_own_materials(CourseImport& import, const std::filesystem::path& file,
                                          const Cis565Line& at);

// Converts one material of an MTL library to a material of the scene.
ScenePart import_mtl_material(CourseImport& import, const MtlMaterial& material, const std::filesystem::path& library,
                              const Cis565Line& at);

}  // namespace pt
