// Compressed wide trees: what they encode, and that their hits are brute force's, bit for bit.
#include "variants/accelerator/cwbvh.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "kernels/triangle.h"
#include "variants/builder/sah_binned.h"

namespace pt {
namespace {

namespace cwbvh = accelerator::cwbvh;
using Mesh = std::vector<Triangle<float>>;
using Point = Vec3<float>;

struct Hit {
    float t = std::numeric_limits<float>::infinity();
    std::uint32_t primitive = ~0u;

    bool operator==(const Hit&) const = default;
};

PrimitiveBoxes boxes_of(const Mesh& mesh) {
    PrimitiveBoxes boxes(mesh.size());
    for (std::size_t i = 0; i < mesh.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            boxes[i].low[k] = std::min({mesh[i].a[k], mesh[i].b[k], mesh[i].c[k]});
            boxes[i].high[k] = std::max({mesh[i].a[k], mesh[i].b[k], mesh[i].c[k]});
        }
    }
    return boxes;
}

void keep_nearer(const Triangle<float>& triangle, std::uint32_t primitive, const Point& origin,
                 const ShearedDirection<float>& shear, Hit& best) {
    const TriangleHit<float> hit = intersect(triangle, origin, shear);
    if (hit.hits && (hit.t < best.t || (hit.t == best.t && primitive < best.primitive))) {
        best = {hit.t, primitive};
    }
}

Hit by_brute_force(const Mesh& mesh, const Point& origin, const Point& direction) {
    const auto shear = ShearedDirection<float>::of(direction);
    Hit best;
    for (std::uint32_t i = 0; i < mesh.size(); ++i) {
        keep_nearer(mesh[i], i, origin, shear, best);
    }
    return best;
}

template <class Counter>
Hit by_tree(const EncodedTree& tree, const Mesh& mesh, const Point& origin, const Point& direction, Counter& counter) {
    const auto shear = ShearedDirection<float>::of(direction);
    Hit best;
    cwbvh::traverse(
        tree.view(), origin, direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t slot = first; slot < first + count; ++slot) {
                const std::uint32_t primitive = tree.references[slot];
                keep_nearer(mesh[primitive], primitive, origin, shear, best);
            }
        },
        counter);
    return best;
}

EncodedTree tree_of(const Mesh& mesh) { return cwbvh::encode(builder::sah_binned::build(boxes_of(mesh), 1)); }

class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float number(float low, float high) { return low + (high - low) * (static_cast<float>(engine_() >> 8) * 0x1p-24f); }
    Point point(float size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
    std::uint32_t below(std::uint32_t n) { return engine_() % n; }

private:
    std::mt19937 engine_;
};

Mesh soup(Random& random, std::uint32_t count, float size) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Point a = random.point(1.0f);
        mesh.push_back({a, a + random.point(size), a + random.point(size)});
    }
    return mesh;
}

// A height field on whole numbers: every inner edge is shared, and many planes are parallel to the axes.
Mesh terrain(Random& random, std::uint32_t n) {
    std::vector<Point> vertices;
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            vertices.push_back({static_cast<float>(i), static_cast<float>(random.below(3)), static_cast<float>(j)});
        }
    }
    Mesh mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.push_back({vertices[a], vertices[b], vertices[c]});
            mesh.push_back({vertices[b], vertices[d], vertices[c]});
        }
    }
    return mesh;
}

// Compares, and returns how many rays hit.
std::uint32_t expect_equal_hits(const Mesh& mesh, std::uint32_t rays,
                                const std::function<std::pair<Point, Point>(std::uint32_t)>& ray) {
    const EncodedTree tree = tree_of(mesh);
    NoTraversalCounter none;
    std::uint32_t hits = 0;
    for (std::uint32_t i = 0; i < rays; ++i) {
        const auto [origin, direction] = ray(i);
        const Hit expected = by_brute_force(mesh, origin, direction),
                  found = by_tree(tree, mesh, origin, direction, none);
        EXPECT_EQ(expected.primitive, found.primitive) << "ray " << i;
        EXPECT_EQ(bits_of(expected.t), bits_of(found.t)) << "ray " << i;
        hits += expected.primitive != ~0u ? 1 : 0;
    }
    return hits;
}

// A ray through an instance has a direction as short as the instance is large.
TEST(Cwbvh, hits_of_short_directions_are_those_of_brute_force) {
    for (const float length : {0x1p-20f, 0x1p-40f, 0x1p-53f, 0x1p-60f}) {
        Random random(8);
        const Mesh mesh = soup(random, 1000, 0.3f);
        const std::uint32_t hits = expect_equal_hits(mesh, 1000, [&](std::uint32_t i) {
            Point direction = random.point(1.0f);
            direction[static_cast<int>(i % 3)] = 0.0f;
            return std::pair(random.point(1.5f), direction * length);
        });
        EXPECT_GT(hits, 100u);
    }
}

TEST(Cwbvh, hits_of_a_soup_are_those_of_brute_force) {
    for (const float size : {0.03f, 0.1f, 2.0f}) {
        Random random(7);
        const Mesh mesh = soup(random, 3000, size);
        const std::uint32_t hits = expect_equal_hits(
            mesh, 2000, [&](std::uint32_t) { return std::pair(random.point(1.5f), random.point(1.0f)); });
        EXPECT_GT(hits, 10u);
    }
}

TEST(Cwbvh, hits_on_shared_edges_and_vertices_are_those_of_brute_force) {
    Random random(11);
    const Mesh mesh = terrain(random, 24);
    const std::uint32_t hits = expect_equal_hits(mesh, 6000, [&](std::uint32_t i) {
        const Triangle<float>& triangle = mesh[random.below(static_cast<std::uint32_t>(mesh.size()))];
        const Point target = i % 3 == 0 ? triangle.a : (triangle.a + triangle.b) * 0.5f;
        const Point origin{random.number(0.0f, 24.0f), random.number(3.0f, 30.0f), random.number(0.0f, 24.0f)};
        return std::pair(origin, target - origin);
    });
    EXPECT_GT(hits, 5900u);
}

TEST(Cwbvh, rays_along_the_axes_and_in_planes_of_boxes_miss_nothing) {
    Random random(13);
    const Mesh mesh = terrain(random, 16);
    const std::uint32_t hits = expect_equal_hits(mesh, 3000, [&](std::uint32_t i) {
        const auto whole = [&](std::uint32_t n) { return static_cast<float>(random.below(n)); };
        Point direction{0.0f, 0.0f, 0.0f};
        direction[static_cast<int>(i % 3)] = i % 2 == 0 ? 1.0f : -1.0f;
        if (i % 5 == 0) {
            direction[static_cast<int>((i + 1) % 3)] = 1e-30f;
        }
        return std::pair(Point{whole(17), whole(4), whole(17)} - direction * 20.0f, direction);
    });
    EXPECT_GT(hits, 500u);
}

TEST(Cwbvh, hits_far_from_the_origin_are_those_of_brute_force) {
    for (const float offset : {1e3f, 1e5f}) {
        Random random(17);
        Mesh mesh = soup(random, 1500, 0.2f);
        for (Triangle<float>& triangle : mesh) {
            for (Point* p : {&triangle.a, &triangle.b, &triangle.c}) {
                *p += Point(offset, -offset, offset);
            }
        }
        const std::uint32_t hits = expect_equal_hits(mesh, 1500, [&](std::uint32_t) {
            return std::pair(Point(offset, -offset, offset) + random.point(3.0f), random.point(1.0f));
        });
        EXPECT_GT(hits, 50u);
    }
}

TEST(Cwbvh, of_equal_triangles_the_first_is_hit) {
    Random random(19);
    const Mesh mesh(500, soup(random, 1, 1.0f)[0]);
    const Point target = (mesh[0].a + mesh[0].b + mesh[0].c) / 3.0f;
    expect_equal_hits(mesh, 100, [&](std::uint32_t) {
        const Point origin = random.point(4.0f);
        return std::pair(origin, target - origin);
    });
}

TEST(Cwbvh, nothing_and_one_triangle) {
    NoTraversalCounter none;
    EXPECT_EQ(Hit{}, by_tree(cwbvh::encode({}), {}, {0, 0, 0}, {0, 0, 1}, none));
    Random random(23);
    const Mesh mesh = soup(random, 1, 1.0f);
    const Point target = (mesh[0].a + mesh[0].b + mesh[0].c) / 3.0f;
    EXPECT_EQ(1u, expect_equal_hits(mesh, 1, [&](std::uint32_t) {
                  return std::pair(Point{0, 9, 0}, target - Point{0, 9, 0});
              }));
}

cwbvh::Node node_at(const EncodedTree& tree, std::uint32_t index) {
    cwbvh::Node node;
    std::memcpy(&node, reinterpret_cast<const unsigned char*>(tree.nodes.data()) + index * sizeof node, sizeof node);
    return node;
}

Box child_box(const cwbvh::Node& node, std::uint32_t child) {
    Box box;
    for (int k = 0; k < 3; ++k) {
        const double step = std::ldexp(1.0, node.exponent[k] - 127), origin = static_cast<double>(node.origin[k]);
        // Exact in double, and its room included: then to float, outward by at most what a float is apart.
        box.low[k] = static_cast<float>(origin + (node.plane[k][0][child] + cwbvh::plane_room) * step);
        box.high[k] = static_cast<float>(origin + (node.plane[k][1][child] - cwbvh::plane_room) * step);
    }
    return box;
}

void expect_inside(const Box& outer, const Box& inner) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(outer.low[k], inner.low[k]);
        EXPECT_GE(outer.high[k], inner.high[k]);
    }
}

// The box of all that lies below a node, which every child's box must hold.
Box walk(const EncodedTree& tree, const PrimitiveBoxes& boxes, std::uint32_t index, std::vector<std::uint32_t>& met) {
    const cwbvh::Node node = node_at(tree, index);
    Box all;
    std::uint32_t child_node = node.child_base, slot = node.slot_base;
    const auto join = [](Box& box, const Box& other) {
        for (int k = 0; k < 3; ++k) {
            box.low[k] = std::min(box.low[k], other.low[k]);
            box.high[k] = std::max(box.high[k], other.high[k]);
        }
    };
    for (std::uint32_t child = 0; child < cwbvh::width; ++child) {
        Box below;
        if ((node.contents >> (24 + child) & 1u) != 0) {
            EXPECT_GT(child_node, index);
            below = walk(tree, boxes, child_node++, met);
        }
        const std::uint32_t slots = node.contents >> (3 * child) & 7u;
        EXPECT_TRUE(slots == 0 || slots == 1 || slots == 3 || slots == 7);
        for (std::uint32_t i = 0; i < bits_in(slots); ++i) {
            const std::uint32_t primitive = tree.references[slot++];
            ++met[primitive];
            join(below, boxes[primitive]);
        }
        if (below.low[0] <= below.high[0]) {
            expect_inside(child_box(node, child), below);
            join(all, below);
        }
    }
    return all;
}

TEST(Cwbvh, boxes_of_children_contain_what_lies_below_and_each_primitive_has_one_slot) {
    for (const float offset : {0.0f, 1e4f}) {
        Random random(29);
        Mesh mesh = soup(random, 2000, 0.05f);
        for (Triangle<float>& triangle : mesh) {
            triangle.a.x += offset, triangle.b.x += offset, triangle.c.x += offset;
        }
        const EncodedTree tree = tree_of(mesh);
        std::vector<std::uint32_t> met(mesh.size(), 0);
        walk(tree, boxes_of(mesh), 0, met);
        EXPECT_EQ(std::vector<std::uint32_t>(mesh.size(), 1), met);
        EXPECT_EQ(mesh.size(), tree.references.size());
        EXPECT_EQ(tree.nodes.size() * sizeof(NodePiece), tree.node_count * sizeof(cwbvh::Node));
    }
}

TEST(Cwbvh, children_are_taken_in_the_order_of_the_octant) {
    for (std::uint32_t flip = 0; flip < 8; ++flip) {
        for (std::uint32_t hits = 1; hits < 256; ++hits) {
            EXPECT_EQ(hits, cwbvh::by_octant(cwbvh::by_octant(hits, flip), flip));
            cwbvh::NodeGroup group{100, (cwbvh::by_octant(hits, flip) << 24) | hits};
            std::uint32_t last = 8, left = hits;
            while (!group.empty()) {
                const std::uint32_t index = group.take_nearest(flip) - 100;
                std::uint32_t slot = 0;
                for (std::uint32_t below = 0; ((hits >> slot) & 1u) == 0 || below++ != index; ++slot) {
                }
                EXPECT_LT(slot ^ flip, last);
                last = slot ^ flip;
                left &= ~(1u << slot);
            }
            EXPECT_EQ(0u, left);
        }
    }
}

// Eight clusters at the corners of a cube: whichever way a ray goes through two, the nearer comes first, and the hit in
// it prunes the other.
TEST(Cwbvh, the_nearer_of_two_children_is_visited_first) {
    Random random(31);
    Mesh mesh;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
        for (int i = 0; i < 40; ++i) {
            Point p = random.point(0.5f);
            for (std::uint32_t k = 0; k < 3; ++k) {
                p[static_cast<int>(k)] += ((corner >> k) & 1u) != 0 ? 5.0f : -5.0f;
            }
            mesh.push_back({p, p + random.point(1.0f), p + random.point(1.0f)});
        }
    }
    const EncodedTree tree = tree_of(mesh);
    std::uint32_t through_first = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
        const Triangle<float>& near = mesh[random.below(static_cast<std::uint32_t>(mesh.size()))];
        const Point target = (near.a + near.b + near.c) / 3.0f;
        Point direction{0.0f, 0.0f, 0.0f};
        direction[static_cast<int>(i % 3)] = target[static_cast<int>(i % 3)] > 0.0f ? -1.0f : 1.0f;
        TraversalCounter one, all;
        const Hit hit = by_tree(tree, mesh, target - direction * 3.0f, direction, one);
        const auto shear = ShearedDirection<float>::of(direction);
        Hit ignored;
        cwbvh::traverse(
            tree.view(), target - direction * 3.0f, direction, std::numeric_limits<float>::infinity(),
            [&](std::uint32_t first, std::uint32_t) {
                keep_nearer(mesh[tree.references[first]], 0, {}, shear, ignored);
            },
            all);
        EXPECT_LE(one.nodes_visited, all.nodes_visited);
        through_first += hit.t < 5.0f && one.nodes_visited < all.nodes_visited ? 1 : 0;
    }
    EXPECT_GT(through_first, 200u);
}

TEST(Cwbvh, large_leaves_are_cut_and_a_tree_too_deep_is_refused) {
    Random random(37);
    const Mesh mesh = soup(random, 16, 0.3f);
    BinaryTree one_leaf;
    const PrimitiveBoxes boxes = boxes_of(mesh);
    one_leaf.nodes.push_back({{{-2, -2, -2}, {2, 2, 2}}, 0, 16});
    for (std::uint32_t i = 0; i < 16; ++i) {
        one_leaf.references.push_back(i);
    }
    const EncodedTree tree = cwbvh::encode(one_leaf);
    std::vector<std::uint32_t> met(mesh.size(), 0);
    walk(tree, boxes, 0, met);
    EXPECT_EQ(std::vector<std::uint32_t>(mesh.size(), 1), met);

    BinaryTree chain;
    chain.nodes.push_back({{{0, 0, 0}, {1, 1, 1}}, 1, 0});
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const std::uint32_t next = static_cast<std::uint32_t>(chain.nodes.size());
        chain.nodes.push_back({{{0, 0, 0}, {1, 1, 1}}, i, 1});
        chain.nodes.push_back({{{0, 0, 0}, {1, 1, 1}}, next + 2, i + 1 == 1000 ? 1u : 0u});
        chain.references.push_back(i);
    }
    chain.nodes.back().first = 1000;
    chain.references.push_back(1000);
    EXPECT_THROW(cwbvh::encode(chain), std::length_error);
}

}  // namespace
}  // namespace pt
