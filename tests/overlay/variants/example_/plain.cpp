#include "variants/registry.h"

namespace pt::example_ {
namespace {

const Registration registration({.axis = "example_",
                                 .name = "plain",
                                 .summary = "the usual choice of a test's axis",
                                 .origin = "this test",
                                 .baseline = on_every_backend,
                                 .backends = on_every_backend},
                                {});

}  // namespace
}  // namespace pt::example_
