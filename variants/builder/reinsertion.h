// Improves a finished tree: subtrees are taken out and put back where the surface areas of all boxes add up to least.
// Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", Eurographics 2018. Places are
// sought in parallel; conflicting moves are left for the next round, in an order that does not depend on the threads.
#pragma once

#include "variants/builder/pairing.h"

namespace pt::builder {

// Reinserts nodes for at most `rounds` rounds, or until a round lessens the sum of surface areas by less than 0.1 %.
void reinsert(Pairing& pairing, const PrimitiveBoxes& boxes, std::uint32_t rounds);

}  // namespace pt::builder
