// The choice levels=each_object: no tree over objects. A ray meets every object that shows a mesh in turn, through the
// object's own tree. The other choices are held against this one.
#include "variants/registry.h"

namespace pt::levels::each_object {
namespace {

const Registration registration(
    {
        .axis = "levels",
        .name = "each_object",
        .summary = "every object that shows a mesh in turn, each by its own tree",
        .origin = "the reference",
        .baseline = on_every_backend,
        .backends = on_every_backend,
    },
    {});

}  // namespace
}  // namespace pt::levels::each_object
