// Tree of a path that splits: the branches are traced one after the other, and their light adds up to the sample's.
// Branches that have yet to begin wait on a small stack; when it is full, paths do not split. Every integrator takes
// the branches in this one order, so a sample has the same bits in all of them.
#pragma once

#include "kernels/shade.h"

namespace pt {

// The most branches that one camera sample may have: rays of many trees together are counted in 32 bits
// (variants/cuda/megakernels.h).
inline constexpr std::uint32_t most_branches_of_tree = 64;

template <class Config>
class PathTree {
public:
    using Real = typename Config::Real;

    // Whether the path is a branch that resumes at the vertex where it split, at `hit()`.
    PT_HD bool resumes() const { return resumes_; }
    PT_HD const Hit<Real>& hit() const { return hit_; }

    // Splits the path at the vertex, or plays roulette (OneBranch has the same interface). Returns whether the path
    // goes on.
    PT_HD bool goes_on(const SceneView<Real>& scene, Path<Real>& path, const Vertex<Real>& vertex, const Hit<Real>& hit,
                       Real u) {
        const bool was_here = resumes_;
        resumes_ = false;
        if (was_here || scene.adjoint == nullptr) {
            return true;
        }
        const AdjointCache<Real>& cache = *scene.adjoint;
        const Real share = expected_share(cache, path, vertex, segments_of<Config>(path));
        const std::uint32_t branches = branch_count(share, cache.highest, cache.most_branches);
        if (branches == 1 || size_ == capacity || promised_ + branches > most_branches_of_tree) {
            return survives_by_share(path, share, cache.lowest, u);
        }
        path.throughput *= Real(1) / static_cast<Real>(branches);
        promised_ += branches - 1;
        waiting_[size_] = {path, hit, branches - 1};
        size_ += 1;
        return true;
    }

    // Replaces `path`, a branch that has ended, by the next waiting branch of its tree, which takes over the radiance
    // that the tree has collected. Returns false if no branch waits: `path` then has all the radiance.
    PT_HD bool take_next(Path<Real>& path) {
        const std::uint32_t segments = segments_of<Config>(path);
        rays_ += segments - first_segment_;
        longest_ = max(longest_, segments);
        if (size_ == 0) {
            return false;
        }
        Waiting& next = waiting_[size_ - 1];
        const Vec3<Real> radiance = path.radiance;
        path = next.path;
        path.radiance = radiance;
        hit_ = next.hit;
        first_segment_ = segments_of<Config>(path);
        branch_ += 1;
        path.segment = (branch_ << segment_bits) | first_segment_;
        next.branches -= 1;
        size_ -= next.branches == 0 ? 1u : 0u;
        resumes_ = true;
        return true;
    }

    // Counts over all branches that have ended: the segments traced, and the segments from the camera to the end of the
    // longest branch.
    PT_HD std::uint32_t rays() const { return rays_; }
    PT_HD std::uint32_t longest() const { return longest_; }

    // Resets the path tree for another camera sample, once no branch is left.
    PT_HD void start_again() { rays_ = longest_ = first_segment_ = branch_ = promised_ = 0; }

private:
    struct Waiting {
        Path<Real> path;  // path at the vertex where it split, with the throughput of one branch
        Hit<Real> hit;
        std::uint32_t branches;
    };
    static constexpr std::uint32_t capacity = 4;

    Waiting waiting_[capacity];
    Hit<Real> hit_;
    std::uint32_t size_ = 0;
    std::uint32_t branch_ = 0;    // number of the branch of the path tree that began last
    std::uint32_t promised_ = 0;  // number of branches of the path tree that have begun or wait, less the first
    std::uint32_t first_segment_ = 0;
    std::uint32_t rays_ = 0, longest_ = 0;
    bool resumes_ = false;
};

// The interface that shade() asks of a branch policy (see OneBranch), for a path that may split.
template <class Tree>
struct BranchOfTree {
    template <class Config>
    static constexpr bool acts_in = true;
    Tree& tree;

    PT_HD bool resumes() const { return tree.resumes(); }
    template <class Config>
    PT_HD bool goes_on(const SceneView<typename Config::Real>& scene, Path<typename Config::Real>& path,
                       const Vertex<typename Config::Real>& vertex, const Hit<typename Config::Real>& hit,
                       typename Config::Real u) const {
        return tree.goes_on(scene, path, vertex, hit, u);
    }
};

// Shades a path that is a branch of a tree, and takes a subsurface walk that begins at the vertex to its end.
template <class Config>
PT_HD inline bool shade_in_tree(const SceneView<typename Config::Real>& scene,
                                const SceneView<typename Config::Real>& traced, Path<typename Config::Real>& path,
                                const Hit<typename Config::Real>& hit, auto& counters, PathTree<Config>& tree) {
    WalkOf<Config> walk;
    bool alive = shade<Config>(scene, traced, path, hit, counters, walk, BranchOfTree<PathTree<Config>>{tree});
    if constexpr (has<Config>(Feature::subsurface)) {
        while (alive && walk.is_on()) {
            alive = walk_on<Config>(scene, path, walk, counters);
        }
    }
    return alive;
}

}  // namespace pt
