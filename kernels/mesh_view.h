// Geometry of a triangle mesh, shared by all its instances, and the interface of accelerators, which take rays through
// it. Kernels get the accelerator as a parameter (Config::Accelerator) and hand it the test of a leaf.
#pragma once

#include "kernels/triangle.h"

namespace pt {

// Tree of an accelerator: nodes in the accelerator's format, aligned to 16 bytes, root first. Empty: no nodes.
struct TreeView {
    const void* nodes = nullptr;
    std::uint32_t node_count = 0;
    std::uint32_t slot_count = 0;  // number of primitive slots in all leaves of the tree
    std::uint32_t node_bytes = 0;  // size of a tree node in bytes
};

// Counters of one ray's traversal; NoTraversalCounter counts nothing and costs nothing.
struct NoTraversalCounter {
    PT_HD void node() {}
    PT_HD void boxes(std::uint32_t) {}
    PT_HD void primitives(std::uint32_t) {}
};
struct TraversalCounter {
    std::uint64_t nodes_visited = 0;
    std::uint64_t boxes_tested = 0;
    std::uint64_t primitives_tested = 0;

    PT_HD void node() { ++nodes_visited; }
    PT_HD void boxes(std::uint32_t count) { boxes_tested += count; }
    PT_HD void primitives(std::uint32_t count) { primitives_tested += count; }
};

// BruteForce tests every primitive in turn: the reference of all accelerators, and their interface. `traverse` calls
// leaf(first, count) for ranges of slots; the leaf's test may lower `best_t`, the limit of the search. Primitives at
// best_t itself must still be handed over: of equal distances the lowest primitive wins.
struct BruteForce {
    static constexpr bool is_chosen_at_run_time = false;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>&, const Vec3<Real>&, const Real&, Leaf&& leaf,
                               Counter& counter) {
        counter.primitives(tree.slot_count);
        leaf(0u, tree.slot_count);
    }
};

// The accelerator of the host's kernels, which are compiled once for all accelerators and call the chosen one by a
// function of the scene (MeshSearch::meet_mesh).
struct RunTimeAccelerator {
    static constexpr bool is_chosen_at_run_time = true;
};

// Texture coordinates u, v of the three corners a, b and c of a triangle.
struct CornerCoordinates {
    float u[3];
    float v[3];
};

// Normals of a triangle's corners in the mesh's own space: unit, outward; all 0: the geometric normal.
struct CornerNormals {
    float of[3][3];
};

// A triangle as a leaf stores it, with its index in the mesh: 48 bytes, three accesses. Row k holds coordinate k of the
// corners, so that a ray's permutation of the axes chooses rows and no components.
struct alignas(16) LeafTriangle {
    struct alignas(16) Row {
        float a, b, c;
        std::uint32_t primitive;
    };
    Row row[3];

    PT_HD static LeafTriangle of(const Triangle<float>& t, std::uint32_t primitive) {
        return {{{t.a.x, t.b.x, t.c.x, primitive}, {t.a.y, t.b.y, t.c.y, primitive}, {t.a.z, t.b.z, t.c.z, primitive}}};
    }
    PT_HD std::uint32_t primitive() const { return row[0].primitive; }
    template <class Real>
    PT_HD Triangle<Real> triangle() const {
        return {{row[0].a, row[1].a, row[2].a}, {row[0].b, row[1].b, row[2].b}, {row[0].c, row[1].c, row[2].c}};
    }
};
static_assert(sizeof(LeafTriangle) == 48);

// A mesh as kernels see it. Coordinates are float in both precisions: it is the same mesh, hit more exactly in double.
struct MeshView {
    const LeafTriangle* leaves = nullptr;        // the mesh's triangles by slot, as in the tree's leaves, with indices
    const Triangle<float>* triangles = nullptr;  // the mesh's triangles by primitive index
    const float* cumulative_area = nullptr;      // cumulative area of the mesh's triangles; emissive meshes only
    TreeView tree;
    const void* native = nullptr;  // what a host accelerator prepared from this mesh for itself
    std::uint32_t triangle_count = 0;
};

}  // namespace pt
