#include <cstdio>
#include "harness/render/renderer.h"
#include "harness/render/image.h"
using namespace pt;
int main(int argc, char** argv) {
  try {
  Scene s = load_scene(argv[1]);
  RenderRequest r; r.variant = Registry::instance().baseline(); r.settings = default_settings(s);
  for (int i = 3; i + 1 < argc; i += 2) r.variant.set(argv[i], argv[i+1]);
  r.samples = 4;
  std::string why = why_not_applicable(r.variant, features_of(s)); if (!why.empty()) { puts(why.c_str()); return 2; }
  for (int k=0;k<3;k++){
  auto res = render(s, r);
  auto m = res.film.mean();
  printf("%s %s mean %.6f %.6f %.6f hash %s rays %lu ms %.2f Mrays/s %.2f nonfinite %lu neg %lu %s [%s]\n", s.name.c_str(), r.variant.name().c_str(), m.x,m.y,m.z,res.film.hash().c_str(), res.work.rays, res.wall_ms, res.work.rays/res.wall_ms/1e3, res.film.faults().nonfinite, res.film.faults().negative, choose_kernel(s,r.variant).note().c_str(), work_missing(r.variant,res.work,r.samples).c_str());
  if (k==0) write_image(res.film, argv[2]);
  }
  } catch (std::exception& e) { puts(e.what()); return 2; }
}
