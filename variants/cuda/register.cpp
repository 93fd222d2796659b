#include "variants/cuda/register.h"

#include "variants/registry.h"

namespace pt::cuda {

Registration::Registration(const Descriptor& descriptor, const Hooks& hooks) {
    Registry::instance().add(descriptor, {.cuda = hooks});
}

}  // namespace pt::cuda
