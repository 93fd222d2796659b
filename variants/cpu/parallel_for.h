// Runs a loop over all cores through Thrust's OpenMP system, in chunks. Only parallel_for.cpp includes Thrust, so a
// kernel's loop is compiled as a plain loop over [begin, end).
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace pt {

namespace detail {
void run_chunks(std::size_t count, std::size_t chunk, void (*run)(void*, std::size_t, std::size_t), void* context);
}

// Calls body(begin, end) for disjoint ranges that cover [0, count), at most `chunk` long, concurrently.
// Neighbouring chunks go to different threads, so that a costly part of an image is shared out.
template <class Body>
void parallel_for(std::size_t count, std::size_t chunk, Body&& body) {
    using Stored = std::remove_reference_t<Body>;
    detail::run_chunks(
        count, chunk,
        [](void* context, std::size_t begin, std::size_t end) { (*static_cast<Stored*>(context))(begin, end); },
        const_cast<void*>(static_cast<const void*>(&body)));
}

// The number of threads that parallel_for uses.
int parallel_threads();

// Wakes threads that sleep because they were idle, so that a measured time does not contain their waking up.
void wake_threads();

}  // namespace pt
