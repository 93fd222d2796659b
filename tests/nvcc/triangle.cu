// What takes a ray to a triangle and decides whether it is hit, alone, as nvcc compiles it where it may fuse a
// multiplication with an addition: nvcc_test.cpp looks at the PTX.
#include "kernels/intersect.h"
#include "variants/bvh/box_ray.h"

namespace pt {

template <class Real>
__global__ void meet(const Triangle<Real>* triangle, const Vec3<Real>* origin, const Vec3<Real>* direction,
                     TriangleHit<Real>* hit) {
    *hit = intersect(*triangle, *origin, ShearedDirection<Real>::of(*direction));
}
template __global__ void meet(const Triangle<float>*, const Vec3<float>*, const Vec3<float>*, TriangleHit<float>*);
template __global__ void meet(const Triangle<double>*, const Vec3<double>*, const Vec3<double>*, TriangleHit<double>*);

template <class Real>
__global__ void take_in(const MeshInstance<Real>* mesh, const Vec3<Real>* point, const Vec3<Real>* direction,
                        Vec3<Real>* local) {
    local[0] = mesh->point_in(*point);
    local[1] = mesh->direction_in(*direction);
}
template __global__ void take_in(const MeshInstance<float>*, const Vec3<float>*, const Vec3<float>*, Vec3<float>*);
template __global__ void take_in(const MeshInstance<double>*, const Vec3<double>*, const Vec3<double>*, Vec3<double>*);

template <class Real>
__global__ void bound(const Vec3<Real>* origin, const Vec3<Real>* direction, const BoxSpan* spans, BoxRay<Real>* ray) {
    const BoxSpan of[3] = {spans[0], spans[1], spans[2]};
    *ray = BoxRay<Real>::of(*origin, *direction, of);
}
template __global__ void bound(const Vec3<float>*, const Vec3<float>*, const BoxSpan*, BoxRay<float>*);
template __global__ void bound(const Vec3<double>*, const Vec3<double>*, const BoxSpan*, BoxRay<double>*);

struct MovingObject {
    const Vec3<float>* velocity;
};
__global__ void move(MovingObject scene, float time, Vec3<float>* point) {
    using Moving = Config<float, set_of(Feature::motion)>;
    point[0] = at_rest<Moving>(scene, 0, point[0], time);
    point[1] = in_motion<Moving>(scene, 0, point[1], time);
}

// That the compiler leaves open what may be fused.
__global__ void may_be_fused(float* a, double* b) {
    *a = a[0] * a[1] - a[2] * a[3];
    *b = b[0] * b[1] - b[2] * b[3];
}

}  // namespace pt
