// What a thread keeps beside the state of its path: nothing or, in kernels whose paths split, the branches that wait
// (kernels/path_tree.h).
#pragma once

#include "kernels/path_tree.h"
#include "variants/cuda/device/device.cuh"

template <bool splits>
struct Branches {
    // Takes one step of a path or, where paths split, of a branch of the path. Returns whether the path lives.
    __device__ bool take_step(const SceneViews& scene, Path& path, pt::WalkOf<Configuration>& walk,
                              const HitCache& cache, ThreadCounters& counters) {
        return ::take_step(scene, path, walk, cache, counters);
    }
    // Traces the path to its end. A kernel with all features has one call of shade, since a second one would double it.
    __device__ void finish(const SceneViews& scene, Path& path, const HitCache& cache, ThreadCounters& counters) {
        if constexpr (pt::has_everything(Configuration::features)) {
            while (shade(scene, path, next_hit(scene, path, cache), counters)) {
            }
        } else {
            bool alive = shade(scene, path, first_hit(scene, path, cache), counters);
            while (alive) {
                alive = shade(scene, path, trace(scene, path), counters);
            }
        }
    }
    // Rays traced for a path that has ended, and segments of its longest branch; both are equal without path splitting.
    __device__ std::uint32_t rays(const Path& path) const { return path.segment; }
    __device__ std::uint32_t longest(const Path& path) const { return path.segment; }
    __device__ void start_again() {}
};

template <>
struct Branches<true> {
    __device__ bool take_step(const SceneViews& scene, Path& path, pt::WalkOf<Configuration>& walk,
                              const HitCache& cache, ThreadCounters& counters) {
        bool alive = false;
        if (walk.is_on()) {
            if constexpr (pt::has<Configuration>(pt::Feature::subsurface)) {
                alive = pt::walk_on<Configuration>(scene.shade, path, walk, counters);
            }
        } else {
            const Hit hit = tree_.resumes() ? tree_.hit() : next_hit(scene, path, cache);
            injected_cost(scene.shade, hit, path);
            alive = pt::shade<Configuration>(scene.shade, scene.trace, path, hit, counters, walk,
                                             pt::BranchOfTree<Tree>{tree_});
        }
        return alive || tree_.take_next(path);
    }
    __device__ void finish(const SceneViews& scene, Path& path, const HitCache& cache, ThreadCounters& counters) {
        pt::WalkOf<Configuration> walk;
        while (take_step(scene, path, walk, cache, counters)) {
        }
    }
    __device__ std::uint32_t rays(const Path&) const { return tree_.rays(); }
    __device__ std::uint32_t longest(const Path&) const { return tree_.longest(); }
    __device__ void start_again() { tree_.start_again(); }

private:
    using Tree = pt::PathTree<Configuration>;
    Tree tree_;
};

using BranchesHere = Branches<pt::has<Configuration>(pt::Feature::splitting)>;
