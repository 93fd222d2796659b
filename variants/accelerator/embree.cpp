// The accelerator embree: Embree's tree with this program's triangle test, as a user geometry whose callbacks give each
// triangle's bounding box and intersect the triangle. Embree's box test knows nothing of the rounding of that triangle
// test, which grows with the distance of the ray origin, so the boxes handed to Embree are wider by a bound on it.
#include <array>
#include <mutex>

#include "kernels/intersect.h"
#include "variants/accelerator/embree_scene.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::embree {
namespace {

// Bounds on direction lengths and mesh sizes handed to Embree, which takes 1e-18 for 0 and 1.8e18 for infinity.
constexpr float smallest = 0x1p-40f, largest = 0x1p40f;

struct Query {
    RTCIntersectContext context;  // first member of Query, since Embree hands callbacks the context's address
    Hit<float>* best;
    const LeafTriangle* leaves;
    MeshRay<float> ray;
    NearerThan<float> end;
};
static_assert(offsetof(Query, context) == 0);

// The tfar for Embree, a little beyond best_t: Embree leaves out boxes entered at tfar, and rounds the distance of
// entry.
float limit(float best_t) { return best_t * (1.0f + gamma<float>(64)) + std::numeric_limits<float>::min(); }

void meet(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) {
        return;
    }
    auto& query = *reinterpret_cast<Query*>(arguments->context);
    meet_triangle(*query.best, query.leaves[arguments->primID], query.ray);
    (void)query.end.end_if_met(*query.best);
    RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, 1), 1, 0) = limit(query.best->t);
}

// A mesh's triangles as an Embree geometry, with bounding boxes that are wider by `margin`.
struct Widened {
    const LeafTriangle* leaves;
    float margin;
};

void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& mesh = *static_cast<const Widened*>(arguments->geometryUserPtr);
    const LeafTriangle& t = mesh.leaves[arguments->primID];
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        const LeafTriangle::Row& row = t.row[axis];
        low[axis] = min(row.a, min(row.b, row.c)) - mesh.margin;
        high[axis] = max(row.a, max(row.b, row.c)) + mesh.margin;
    }
    *arguments->bounds_o = {low[0], low[1], low[2], 0, high[0], high[1], high[2], 0};
}

// A mesh for Embree: a tree for rays that start near the mesh, and trees of wider boxes, made when a ray asks for one,
// for rays from afar.
class Mesh : public HostMesh {
public:
    explicit Mesh(std::span<const LeafTriangle> leaves) : leaves_(leaves) {
        for (const LeafTriangle& leaf : leaves) {
            for (int axis = 0; axis < 3; ++axis) {
                const LeafTriangle::Row& row = leaf.row[axis];
                low_[axis] = min(low_[axis], min(row.a, min(row.b, row.c)));
                high_[axis] = max(high_[axis], max(row.a, max(row.b, row.c)));
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            size_ = max(size_, max(absolute(low_[axis]), max(absolute(high_[axis]), high_[axis] - low_[axis])));
        }
    }

    // Returns the Embree tree that finds all triangles that this ray meets; null: no tree's boxes are wide enough, and
    // every triangle is to be tested in turn.
    RTCScene scene_for(const MeshRay<float>& ray) const {
        const Vec3<float>& d = ray.direction;
        const float length = max(absolute(d.x), max(absolute(d.y), absolute(d.z)));
        if (!(length >= smallest && length <= largest && size_ >= smallest && size_ <= largest)) {
            return nullptr;
        }
        const float margin = margin_for(ray.origin);
        for (std::size_t level = 0; level < levels_.size(); ++level) {
            if (margin <= margin_of(level)) {
                return tree(level);
            }
        }
        return nullptr;
    }

    std::uint64_t bytes() const { return leaves_.size() * sizeof(RTCBounds); }

private:
    struct Level {
        std::once_flag once;
        Widened widened;
        Scene scene;
    };

    // The margin on boxes for rays from `origin`: twice that of BoxRay, and as much again for Embree's rounding of side
    // * (1 / d) - origin * (1 / d) in its slab test.
    float margin_for(const Vec3<float>& origin) const {
        float reach = 0, from_zero = 0;
        for (int axis = 0; axis < 3; ++axis) {
            reach = max(reach, max(absolute(low_[axis] - origin[axis]), absolute(high_[axis] - origin[axis])));
            from_zero = max(from_zero, absolute(origin[axis]));
        }
        return gamma<float>(64) * reach + gamma<float>(16) * from_zero;
    }
    float margin_of(std::size_t level) const { return gamma<float>(64) * size_ * static_cast<float>(4u << 4 * level); }

    RTCScene tree(std::size_t number) const {
        Level& level = levels_[number];
        std::call_once(level.once, [&] {
            level.widened = {leaves_.data(), margin_of(number)};
            RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(leaves_.size()));
            rtcSetGeometryUserData(geometry, &level.widened);
            rtcSetGeometryBoundsFunction(geometry, &bounds, nullptr);
            rtcSetGeometryIntersectFunction(geometry, &meet);
            level.scene = scene_of(geometry, RTC_SCENE_FLAG_ROBUST);
        });
        return level.scene.get();
    }

    std::span<const LeafTriangle> leaves_;  // triangles owned by the MeshTree that also owns this mesh
    float low_[3] = {largest, largest, largest}, high_[3] = {-largest, -largest, -largest};
    float size_ = 0;
    mutable std::array<Level, 5> levels_;
};

NativeMesh prepare(const EncodedTree&, std::span<const LeafTriangle> leaves) {
    auto mesh = std::make_shared<Mesh>(leaves);
    const MeshRay<float> near{
        {leaves.empty() ? 0 : leaves[0].row[0].a, 0, 0}, {1, 0, 0}, {}, {}, 0, MeshRay<float>::nothing};
    mesh->scene_for(near);
    const std::uint64_t bytes = mesh->bytes();
    return {std::move(mesh), bytes};
}

void meet_mesh(Hit<float>& best, const MeshInstance<float>& instance, std::uint32_t object, const Vec3<float>& origin,
               const Ray<float>& ray, float enough) {
    Query query{{}, &best, instance.geometry.leaves, MeshRay<float>::of(instance, object, origin, ray), {enough}};
    const RTCScene scene = mesh_of<Mesh>(instance).scene_for(query.ray);
    if (scene == nullptr) {
        pt::meet_mesh<BruteForce>(best, instance, object, origin, ray, enough);
        return;
    }
    rtcInitIntersectContext(&query.context);
    const Vec3<float>&o = query.ray.origin, &d = query.ray.direction;
    RTCRayHit met{};
    met.ray = {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, limit(best.t), ~0u, 0, 0};
    met.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &query.context, &met);
}

const Registration registration(
    {
        .axis = "accelerator",
        .name = "embree",
        .summary = "Embree's tree, with this program's triangle test",
        .origin = "Wald et al. 2014",
        .traits = AcceleratorTraits{.has_tree = false, .builds_itself = true},
        .backends = on_cpu,
        .unsupported_reason = needs_embree_rays,
    },
    {.accelerator = {nullptr, &prepare, &meet_mesh, &pt::meet_mesh<BruteForce, double>}});

}  // namespace
}  // namespace pt::accelerator::embree
