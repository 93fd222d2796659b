#include "variants/registry.h"

namespace pt::example_ {
namespace {

const Registration registration(
    {.axis = "example_",
     .name = "other",
     .summary = "another choice of a test's axis",
     .origin = "this test",
     .traits = ExampleTraits{.value = 2},
     .backends = on_every_backend,
     .unsupported_reason =
         [](FeatureSet, const VariantTraits& variant) {
             return variant.example_.value == 2 ? Reason{"is_other", "is for a test"} : Reason{};
         }},
    {});

}  // namespace
}  // namespace pt::example_
