// The materials of a mesh's own file: those that an .obj names by usemtl and that its library, an .mtl, has. Each
// becomes a material of the scene, and its triangles an object.
//
// How a library is read. W: a warning, for what it says and scene files lack.
// - Ke not 0: an emitter of that radiance; paths end there, so Kd is not used (W).
// - illum 4, 6, 7 and 9: glass of index Ni (1.5 without it: W), tinted by Tf; Kd is not used (W).
// - illum 3, 5 and 8, with a Ks: what Kd and Ks reflect, together: a mix whose probabilities are as Kd and Ks, so that
//   the sum is exact where it is at most 1, and scaled down to 1 where it is more (W); without a Kd a mirror. Of illum
//   5 the share of Fresnel is lost (W). A map_Kd is shown without the mirror (W).
// - else diffuse, Kd or the image of map_Kd (read as TEXTURE of a material is: W; so is a Kd beside it other than
//   white). Ks, highlights of lamps, is lost (W). illum 0, without shading, is read as 1 (W).
// - Ka, Ns and sharpness mean nothing to paths. What maps say of Ks and Ns, and the keys of metals and coats (Pr, Pm,
//   Ps, Pc, aniso), are lost (W). d below 1, or Tr above 0, on what is no glass, and maps of normals, bumps,
//   displacement, opacity and emission are problems, as whatever else is not known.
// - Names go to the line's end; where nothing is called so, a # behind a space begins a comment (W). Of two materials
// of one
//   name the first is used, of two lines of one key the last (W, where they differ).
// - Faces whose material no library has take one of the name of their group (W): one dialect means them so.
#pragma once

#include <filesystem>

#include "harness/interchange/course_scene.h"
#include "harness/mesh/obj_materials.h"

namespace pt {

// Objects for the mesh `file`, each of one material: none, and told, where there are problems. `at`: the scene's line
// that names it.
std::vector<OwnPart> import_own_materials(CourseImport& import, const std::filesystem::path& file,
                                          const Cis565Line& at);

// Reads one material, of the library `library`.
ScenePart import_mtl_material(CourseImport& import, const MtlMaterial& material, const std::filesystem::path& library,
                              const Cis565Line& at);

}  // namespace pt
