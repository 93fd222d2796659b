// The choice levels=flat: one tree over the triangles of all objects, in the accelerator's format and by its builder.
// No object's box is entered for nothing, at the price of a slot for every triangle of every instance. A triangle is
// intersected in its object's own space, so that its hit has the bits that it has by the object's own tree.
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::levels::flat {
namespace {

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    if (Reason reason = needs_search(scene, variant); !reason.empty()) {
        return reason;
    }
    if (!variant.accelerator.has_tree) {
        return {"needs_tree", "is a tree in the accelerator's format: needs another accelerator than " +
                                  std::string(variant.accelerator.name)};
    }
    if (variant.builder.splits_primitives) {
        return {"splits_primitives", "is over boxes that hold the rounding of instances, of which builder=" +
                                         std::string(variant.builder.name) + ", which splits triangles, knows nothing"};
    }
    return {};
}

constexpr Descriptor descriptor_on(BackendSet backends) {
    return {
        .axis = "levels",
        .name = "flat",
        .summary = "one tree over the triangles of all objects, instances included",
        .origin = "the usual bounding volume hierarchy",
        .traits = LevelsTraits{.is_flat = true},
        .backends = backends,
        .unsupported_reason = unsupported_reason,
    };
}

const Registration on_the_cpu(descriptor_on(on_cpu), {.levels = {nullptr, nullptr, nullptr, true}});
const Registration on_the_gpu(descriptor_on(on_cuda), {.features = [] { return no_features | Feature::flat_tree; },
                                                       .levels = {nullptr, nullptr, nullptr, true}});

}  // namespace
}  // namespace pt::levels::flat
