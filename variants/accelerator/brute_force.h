// Every triangle in turn: what the other accelerators are held against.
#pragma once

#include "kernels/intersect.h"

namespace pt::accelerator::brute_force {

using Traversal = BruteForce;

}  // namespace pt::accelerator::brute_force
