// The traversal stack `local`: all entries in the thread's local memory.
#pragma once

#include "variants/bvh/stacks.h"

namespace pt::traversal_stack::local {

template <class Open, std::uint32_t most>
using Stack = FullStack<Open, LocalMemory<Open, most>>;

}  // namespace pt::traversal_stack::local
