// What NVRTC's text would say before the kernels of a program with accelerator=cwbvh and traversal=persistent, for
// tests on threads of the host (block_on_threads.h). A test includes it after it has defined kernel_config, the
// constants in `tuned`, and host_bytes for its kernels.
#pragma once

#include <algorithm>

#include "tests/support/key_of_material.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/layout/aos.cuh"

using std::max;
using std::min;

using Real = float;
using Paths = pt::layout::aos::DevicePaths<Real>;
#include "variants/traversal/persistent.cuh"
#include "variants/traversal_stack/local.cuh"
using Accelerator =
    pt::traversal::persistent::Traversal<pt::accelerator::cwbvh::Traversal, pt::traversal_stack::local::Stack>;
#include "variants/cuda/device/scene_in_global.cuh"
// After it: they need no more than its names.
#include "variants/cuda/device/pixels_all.cuh"
#include "variants/integrator/wavefront_fetching.cuh"
