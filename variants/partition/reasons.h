// Why an image cannot be shared out between several GPUs in a variant, for the choices of the axis `partition`.
#pragma once

#include "variants/registry.h"

namespace pt {

inline Reason needs_several_devices(const VariantTraits& variant) {
    return variant.devices.count > 1
               ? Reason{}
               : Reason{"needs_devices", "splits work between GPUs: needs devices=2 or more, not 1"};
}

}  // namespace pt
