// Every kernel header through nvcc, host and device: the four stages as kernels, for every feature in both precisions
// and for one small feature set. Compiled by nvcc_test; never run.
#include "kernels/absorption.h"
#include "kernels/adjoint.h"
#include "kernels/axis_aligned_enclosure.h"
#include "kernels/boundary.h"
#include "kernels/box.h"
#include "kernels/camera.h"
#include "kernels/config.h"
#include "kernels/environment_map.h"
#include "kernels/film.h"
#include "kernels/ggx.h"
#include "kernels/ggx_gain.h"
#include "kernels/guided_walk.h"
#include "kernels/health.h"
#include "kernels/in_range.h"
#include "kernels/intersect.h"
#include "kernels/light.h"
#include "kernels/light_direction.h"
#include "kernels/light_sampling.h"
#include "kernels/light_selection.h"
#include "kernels/line_of_sight.h"
#include "kernels/lobe.h"
#include "kernels/material_list.h"
#include "kernels/materials.h"
#include "kernels/math.h"
#include "kernels/medium.h"
#include "kernels/mesh_view.h"
#include "kernels/naive.h"
#include "kernels/near_rectangle.h"
#include "kernels/nearest_surface.h"
#include "kernels/next_event.h"
#include "kernels/object_tree.h"
#include "kernels/path.h"
#include "kernels/path_fields.h"
#include "kernels/path_tree.h"
#include "kernels/pick_header.h"
#include "kernels/random_words.h"
#include "kernels/rng.h"
#include "kernels/russian_roulette.h"
#include "kernels/sampler_list.h"
#include "kernels/sampling.h"
#include "kernels/scattering.h"
#include "kernels/scene_arrays.h"
#include "kernels/scene_view.h"
#include "kernels/shade.h"
#include "kernels/shading_normal.h"
#include "kernels/shape.h"
#include "kernels/shape_list.h"
#include "kernels/shapes.h"
#include "kernels/solid_angle.h"
#include "kernels/texture.h"
#include "kernels/transform.h"
#include "kernels/triangle.h"
#include "kernels/unit_sphere.h"
#include "kernels/vertex.h"
#include "kernels/visit_shape.h"
#include "kernels/widen.h"

namespace pt {

template <class Config>
__global__ void generate_paths(SceneView<typename Config::Real> scene, Path<typename Config::Real>* paths,
                               std::uint32_t sample) {
    const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
    if (pixel < scene.pixel_count()) {
        paths[pixel] = generate<Config>(scene, pixel, sample);
    }
}

template <class Config>
__global__ void intersect_paths(SceneView<typename Config::Real> scene, const Path<typename Config::Real>* paths,
                                Hit<typename Config::Real>* hits, std::uint32_t count) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count && paths[i].alive()) {
        hits[i] = intersect<Config>(scene, paths[i]);
    }
}

template <class Config>
__global__ void shade_paths(SceneView<typename Config::Real> scene, Path<typename Config::Real>* paths,
                            const Hit<typename Config::Real>* hits, PathCounters* counters, std::uint32_t count) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count && paths[i].alive()) {
        paths[i].segment =
            shade<Config>(scene, scene, paths[i], hits[i], counters[i]) ? paths[i].segment : Path<float>::ended;
    }
}

template <class Config>
__global__ void accumulate_paths(FilmView film, const Path<typename Config::Real>* paths, std::uint32_t count) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) {
        accumulate(film, paths[i]);
    }
}

// The host side of the same functions.
template <class Config>
void on_host(const SceneView<typename Config::Real>& scene, const FilmView& film, PathCounters& counters) {
    Path<typename Config::Real> path = generate<Config>(scene, 0, 0);
    while (shade<Config>(scene, scene, path, intersect<Config>(scene, path), counters)) {
    }
    accumulate(film, path);
}

#define PT_INSTANTIATE(CONFIG)                                                                                    \
    template __global__ void generate_paths<CONFIG>(SceneView<CONFIG::Real>, Path<CONFIG::Real>*, std::uint32_t); \
    template __global__ void intersect_paths<CONFIG>(SceneView<CONFIG::Real>, const Path<CONFIG::Real>*,          \
                                                     Hit<CONFIG::Real>*, std::uint32_t);                          \
    template __global__ void shade_paths<CONFIG>(SceneView<CONFIG::Real>, Path<CONFIG::Real>*,                    \
                                                 const Hit<CONFIG::Real>*, PathCounters*, std::uint32_t);         \
    template __global__ void accumulate_paths<CONFIG>(FilmView, const Path<CONFIG::Real>*, std::uint32_t);        \
    template void on_host<CONFIG>(const SceneView<CONFIG::Real>&, const FilmView&, PathCounters&);

// Without tangents of images, which are in double: of small triangles they would be nothing.
using Everything = Config<float, (all_features & ~static_cast<FeatureSet>(Feature::shading_normals)) | samplings>;
using EverythingDouble = Config<double, all_features | samplings>;
using Small = Config<float, Feature::axis_box | Feature::diffuse | Feature::emitter | Feature::jitter>;

PT_INSTANTIATE(Everything)
PT_INSTANTIATE(EverythingDouble)
PT_INSTANTIATE(Small)

// With meshes, whose triangles are in single precision and whose edges ask for double: counted apart, by their names.
struct WithMeshes : Config<float, all_features | samplings | traversals> {};
struct WithMeshesInDouble : Config<double, all_features | samplings | traversals> {};
PT_INSTANTIATE(WithMeshes)
PT_INSTANTIATE(WithMeshesInDouble)

}  // namespace pt
