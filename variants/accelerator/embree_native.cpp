// The accelerator embree_native: Embree's tree and triangle test, as in a renderer that leaves rays to a library. Hit
// distances differ from this program's in the last bits, and at edges the triangles hit do; a point on a surface is
// still computed by this program's test, which has to agree that the triangle is hit.
#include <cstring>

#include "kernels/intersect.h"
#include "variants/accelerator/embree_scene.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::embree_native {
namespace {

namespace embree = accelerator::embree;

struct Query {
    RTCIntersectContext context;  // first member of Query, since Embree hands its filter the context's address
    std::uint32_t origin_primitive;
};
static_assert(offsetof(Query, context) == 0);

void pass_over_origin(const RTCFilterFunctionNArguments* arguments) {
    const auto& query = *reinterpret_cast<const Query*>(arguments->context);
    if (RTCHitN_primID(arguments->hit, arguments->N, 0) == query.origin_primitive) {
        arguments->valid[0] = 0;
    }
}

struct Mesh : HostMesh {
    embree::Scene scene;
};

NativeMesh prepare(const EncodedTree&, std::span<const LeafTriangle> leaves) {
    RTCGeometry geometry = rtcNewGeometry(embree::device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                3 * sizeof(float), 3 * leaves.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), leaves.size()));
    embree::require_no_error("take triangles over");
    for (std::uint32_t i = 0; i < leaves.size(); ++i) {
        const auto triangle = leaves[i].triangle<float>();
        std::memcpy(corners + 9 * i, &triangle, 9 * sizeof(float));
        for (std::uint32_t k = 0; k < 3; ++k) {
            indices[3 * i + k] = 3 * i + k;
        }
    }
    const auto mesh = std::make_shared<Mesh>();
    mesh->scene = embree::scene_of(
        geometry, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    const std::uint64_t bytes = leaves.size() * (9 * sizeof(float) + 3 * sizeof(std::uint32_t));
    return {mesh, bytes};
}

void meet_mesh(Hit<float>& best, const MeshInstance<float>& instance, std::uint32_t object, const Vec3<float>& origin,
               const Ray<float>& ray, float enough) {
    const MeshRay<float> in_mesh = MeshRay<float>::of(instance, object, origin, ray);
    Query query{{}, in_mesh.passed_over};
    rtcInitIntersectContext(&query.context);
    query.context.filter = in_mesh.passed_over != MeshRay<float>::nothing ? &pass_over_origin : nullptr;
    const Vec3<float>&o = in_mesh.origin, &d = in_mesh.direction;
    const RTCScene scene = mesh_of<Mesh>(instance).scene.get();
    if (enough > 0) {
        // An occlusion test ends at any hit nearer than `enough`. Embree decides by distances of its own, and accepts a
        // hit at `enough` itself, too, which embree_native's claim on the film allows.
        RTCRay any{o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, enough, ~0u, 0, 0};
        rtcOccluded1(scene, &query.context, &any);
        if (any.tfar < 0) {
            best = {-1.0f, SurfaceId::of(object, false)};
            return;
        }
    }
    RTCRayHit met{};
    met.ray = {o.x, o.y, o.z, enough, d.x, d.y, d.z, 0, best.t, ~0u, 0, 0};
    met.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &query.context, &met);
    if (met.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return;
    }
    const LeafTriangle& leaf = instance.geometry.leaves[met.hit.primID];
    const TriangleHit<float> hit = intersect(leaf.triangle<float>(), in_mesh.origin, in_mesh.sheared);
    if (!hit.hits) {  // Embree's triangle test and `intersect` differ at edges, for a few rays in a million
        pt::meet_mesh<BruteForce>(best, instance, object, origin, ray, enough);
        return;
    }
    best.t = met.ray.tfar;
    best.side = SurfaceId::of(object, hit.from_behind);
    best.primitive = leaf.primitive();
}

const Registration registration(
    {
        .axis = "accelerator",
        .name = "embree_native",
        .summary = "Embree's tree and Embree's triangle test",
        .origin = "Wald et al. 2014",
        .claim = Claim::statistical,
        .claim_note = "same expectation as accelerator=bvh2, up to the rounding of Embree's distances",
        .mean_of = "bvh2",
        .traits = AcceleratorTraits{.has_tree = false, .builds_itself = true},
        .backends = on_cpu,
        .unsupported_reason = embree::needs_embree_rays,
    },
    {.accelerator = {nullptr, &prepare, &meet_mesh, &pt::meet_mesh<BruteForce, double>}});

}  // namespace
}  // namespace pt::accelerator::embree_native
