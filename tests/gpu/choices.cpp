#include "tests/gpu/choices.h"

#include <stdexcept>

#include "variants/registry.h"

namespace pt::test {
namespace {

const Choice& choice(std::string_view axis, std::string_view name) {
    const Choice* const found = Registry::instance().find(axis, name, Backend::cuda);
    if (found == nullptr) {
        throw std::runtime_error("no choice " + std::string(axis) + "=" + std::string(name) + " on cuda");
    }
    return *found;
}

}  // namespace

const Descriptor& cuda_descriptor(std::string_view axis, std::string_view name) {
    return choice(axis, name).descriptor;
}

const cuda::Hooks& cuda_hooks(std::string_view axis, std::string_view name) { return choice(axis, name).hook.cuda; }

}  // namespace pt::test
