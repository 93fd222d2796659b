// A warp of persistent threads that works off a queue of rays: lanes that fall idle fetch the next rays (Aila and
// Laine, HPG 2009), and lanes vote whether to take a step through nodes or to test triangles (Ylitie, Karras, Laine,
// HPG 2017, section 4). For kernels that nvcc and NVRTC compile. A State is one lane's ray: active(), start(index),
// which may leave it idle, wants_node(), visit_node(), wants_triangle(), test_triangle().
#pragma once

#include <cstdint>

namespace pt::traversal {

// When a warp fetches rays and what it does next. refill: the number of idle lanes at which the warp fetches; 32: when
// all are idle. vote: the warp takes a step through nodes where vote x the lanes that want one >= 4 x the lanes that
// want to test a triangle; 0: one node, then all triangles found in it.
template <int Refill, int Vote>
struct WarpPolicy {
    static constexpr int refill = Refill;
    static constexpr int vote = Vote;
};

inline constexpr unsigned every_lane = 0xffffffffu;

__device__ inline std::uint32_t lanes_in(unsigned mask) { return static_cast<std::uint32_t>(__popc(mask)); }

// Lets idle lanes take the next of `count` rays; `next` is the first ray that no warp has fetched. False: none is left.
template <class State>
__device__ inline bool fetch(State& state, std::uint32_t* next, std::uint32_t count, bool& exhausted) {
    const unsigned idle = __ballot_sync(every_lane, !state.active());
    const std::uint32_t lane = threadIdx.x & 31u;
    if (!exhausted) {
        std::uint32_t first = 0;
        if (lane == 0) {
            first = atomicAdd(next, lanes_in(idle));
        }
        first = __shfl_sync(every_lane, first, 0);
        exhausted = first + lanes_in(idle) >= count;
        const std::uint32_t index = first + lanes_in(idle & ((1u << lane) - 1u));
        if (!state.active() && index < count) {
            state.start(index);
        }
    }
    return !exhausted || __any_sync(every_lane, state.active());
}

// Takes one step of a warp of persistent threads, through nodes or over triangles, for the lanes that want it.
template <class Policy, class State>
__device__ inline void step(State& state) {
    if constexpr (Policy::vote == 0) {
        if (state.wants_node()) {
            state.visit_node();
        }
        while (state.wants_triangle()) {
            state.test_triangle();
        }
    } else {
        const std::uint32_t nodes = lanes_in(__ballot_sync(every_lane, state.wants_node()));
        const std::uint32_t triangles = lanes_in(__ballot_sync(every_lane, state.wants_triangle()));
        if (nodes != 0 && nodes * Policy::vote >= 4u * triangles) {
            if (state.wants_node()) {
                state.visit_node();
            }
        } else if (state.wants_triangle()) {
            state.test_triangle();
        }
    }
}

// Traces all rays of a queue. Every lane of the warp must call it.
template <class Policy, class State>
__device__ inline void work_off(State& state, std::uint32_t* next, std::uint32_t count) {
    bool exhausted = false;
    while (fetch(state, next, count, exhausted)) {
        unsigned idle = 0;
        do {
            step<Policy>(state);
            idle = __ballot_sync(every_lane, !state.active());
        } while (exhausted ? idle != every_lane : lanes_in(idle) < static_cast<std::uint32_t>(Policy::refill));
    }
}

}  // namespace pt::traversal
