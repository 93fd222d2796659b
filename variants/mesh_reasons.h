// Reasons for which choices of the axes `accelerator` and `builder` cannot run, by the scene or by other choices.
#pragma once

#include "variants/descriptor.h"

namespace pt {

inline Reason needs_meshes(FeatureSet scene, const VariantTraits&) {
    return contains(scene, Feature::mesh) ? Reason{}
                                          : Reason{"needs_meshes", "has nothing to do: the scene has no mesh"};
}

// Why a choice that searches all objects with meshes together, as by a top-level tree, does not apply; empty: it
// applies.
inline Reason needs_search(FeatureSet scene, const VariantTraits& variant) {
    if (Reason reason = needs_meshes(scene, variant); !reason.empty()) {
        return reason;
    }
    return variant.traversal.needs_own_kernel
               ? Reason{"needs_search", "is not there with traversal=" + std::string(variant.traversal.name) +
                                            ", whose kernel meets each object in turn"}
               : Reason{};
}

// Why a choice with ray tests of its own for shapes, and none for meshes, does not apply; empty: it applies.
inline Reason meets_no_mesh(FeatureSet scene) {
    return contains(scene, Feature::mesh)
               ? Reason{"meets_no_mesh", "meets shapes in a way of its own that has none for meshes"}
               : Reason{};
}

inline Reason needs_tree(FeatureSet scene, const VariantTraits& variant) {
    if (Reason reason = needs_meshes(scene, variant); !reason.empty()) {
        return reason;
    }
    if (variant.accelerator.builds_itself) {
        return {"needs_tree",
                "has nothing to do: accelerator=" + std::string(variant.accelerator.name) + " builds its own tree"};
    }
    return variant.accelerator.has_tree
               ? Reason{}
               : Reason{"needs_tree",
                        "has nothing to do: accelerator=" + std::string(variant.accelerator.name) + " needs no tree"};
}

// Why a choice that orders the steps of a mesh traversal in its own way does not apply; empty: it applies.
inline Reason needs_steps(FeatureSet scene, const VariantTraits& variant) {
    Reason reason = needs_tree(scene, variant);
    if (reason.empty() && !variant.accelerator.has_steps) {
        return {"needs_steps", "needs a traversal in steps, which accelerator=" +
                                   std::string(variant.accelerator.name) + " does not have"};
    }
    return reason;
}

}  // namespace pt
