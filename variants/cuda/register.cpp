#include "variants/cuda/register.h"

#include "variants/registry.h"

namespace pt::cuda {

Registration::Registration(const Descriptor& descriptor, const Hooks& hooks) {
    Registry::instance().add(descriptor, {.cuda = hooks});
}

bool keeps_payload_contiguous(const Variant& variant) {
    return Registry::instance().at("compaction", variant, Backend::cuda).descriptor.keeps_payload_contiguous;
}

}  // namespace pt::cuda
