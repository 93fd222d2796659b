// A surface that emits and reflects nothing: paths end on it.
#pragma once

namespace pt {

template <class Real>
struct EmitterMaterial {};

}  // namespace pt
