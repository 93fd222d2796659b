#include "harness/cuda/device_scene.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt::cuda {

namespace {

// The bytes of the scene's arrays as they are laid out in constant memory (scene_in_constant.cuh).
template <class Real>
std::vector<unsigned char> constant_scene(const SceneView<Real>& scene, FeatureSet features) {
    std::vector<unsigned char> bytes;
    for_each_array(scene, [&](const SceneArray& array, const auto& view) {
        if (!array.is_traced(features)) {
            return;
        }
        const auto* const begin = reinterpret_cast<const unsigned char*>(view.data);
        bytes.insert(bytes.end(), begin, begin + view.size * sizeof(*view.data));
        bytes.resize((bytes.size() + 15) / 16 * 16);
    });
    return bytes;
}

class BakedText {
public:
    template <class T>
    void add(const char* name, const T* values, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
        std::vector<T> cleared(values, values + count);
        for (T& value : cleared) {
            __builtin_clear_padding(&value);  // padding bytes would get into the kernel's cache key
        }
        std::vector<std::uint32_t> words(std::max<std::size_t>(1, count * sizeof(T) / 4));
        if (count != 0) {
            std::memcpy(words.data(), static_cast<const void*>(cleared.data()), count * sizeof(T));
        }
        text_ +=
            fmt::format("__device__ alignas(16) const unsigned {}[] = {{{:#x}u}};\n", name, fmt::join(words, "u,"));
    }
    template <class T>
    void add(const char* name, const View<T>& view) {
        add(name, view.data, view.size);
    }
    void add_count(const char* name, std::uint32_t count) {
        text_ += fmt::format("constexpr unsigned {} = {}u;\n", name, count);
    }
    std::string text() const { return "namespace baked { namespace {\n" + text_ + "} }\n"; }

private:
    std::string text_;
};

template <class T>
void copy_to_device(const View<T>& device, const View<T>& host, cudaStream_t stream) {
    if (host.size != 0) {
        PT_CUDA_CHECK(cudaMemcpyAsync(const_cast<T*>(device.data), host.data, host.size * sizeof(T),
                                      cudaMemcpyHostToDevice, stream));
    }
}

// Whether a scene array of this type can be compiled into a kernel; one with addresses (mesh instances) cannot.
template <class T>
inline constexpr bool is_baked = true;
template <class Real>
inline constexpr bool is_baked<MeshInstance<Real>> = false;

template <class T>
View<T> placed(Arena& arena, const View<T>& host) {
    return {arena.take<T>(host.size), host.size};
}

}  // namespace

template <class Real>
std::string scene_place(const SceneView<Real>& scene, FeatureSet features, bool is_baked) {
    if (is_baked) {
        return "baked";
    }
    return constant_scene(scene, features).size() <= constant_bytes ? scene_in_constant : "in_global";
}

template <class Real>
void fix_counts(const SceneView<Real>& scene, KernelConfig& config) {
    // A kernel with all features serves all scenes, so no counts of objects are compiled into it.
    if (has_everything(config.features)) {
        return;
    }
    config.has_fixed_counts = true;
    FixedCounts& counts = config.counts;
#define PT_COUNT(name, kind, word) counts.name = scene.name.size;
    PT_OBJECT_ARRAYS(PT_COUNT)
#undef PT_COUNT
    const AxisAlignedEnclosure<Real>& enclosure = scene.enclosure;
    counts.walls = enclosure.walls;
    counts.lamps = enclosure.lamps;
    counts.open_sides = enclosure.open_sides;
    for (int axis = 0; axis < 3; ++axis) {
        counts.low_sides[axis] = enclosure.low_side[axis].code;
        counts.high_sides[axis] = enclosure.high_side[axis].code;
    }
    counts.one_light = scene.lights.size == 1 ? scene.lights[0].object : FixedCounts::none;
}

template <class Real>
std::string baked_text(const SceneView<Real>& scene) {
    BakedText text;
    for_each_array(scene, [&](const SceneArray& array, const auto& view) {
        using Element = std::remove_cvref_t<decltype(*view.data)>;
        if (array.kind != ArrayKind::matrix && array.kind != ArrayKind::selection && array.kind != ArrayKind::texture) {
            text.add(array.name, is_baked<Element> ? view : View<Element>{});
        }
    });
    text.add("environment", &scene.environment, 1);
    text.add("enclosure", &scene.enclosure, 1);
    Camera<Real> camera = scene.camera;  // camera without image size and pixel size, so that one kernel serves all
    camera.width = camera.height = 0;
    camera.pixel_size = 0;
    text.add("camera", &camera, 1);
#define PT_ADD_COUNT(name, kind, word) text.add_count(#word "_count", scene.name.size);
    PT_SHARED_ARRAYS(PT_ADD_COUNT)
#undef PT_ADD_COUNT
    return text.text();
}

template <class Real>
DeviceScene<Real>::DeviceScene(const SceneView<Real>& host, const std::vector<MeshGeometry>& meshes,
                               const std::shared_ptr<const SceneTree>& tree, FeatureSet features, bool is_baked)
    : host_(host), features_(features), is_baked_(is_baked), tree_(device_tree(tree)) {
    for (const MeshGeometry& mesh : meshes) {
        device_meshes_.push_back(device_mesh(mesh));
    }
}

template <class Real>
std::size_t DeviceScene<Real>::mesh_bytes() const {
    const std::set<std::shared_ptr<const DeviceMesh>> each(device_meshes_.begin(), device_meshes_.end());
    std::size_t bytes = 0;
    for (const std::shared_ptr<const DeviceMesh>& mesh : each) {
        bytes += mesh->bytes();
    }
    return bytes + (tree_ != nullptr ? tree_->bytes() : 0);
}

template <class Real>
void DeviceScene<Real>::reserve(Arena& arena) {
    view_ = host_;
    for_each_array(view_, host_, [&](const SceneArray& array, auto& device, const auto& host) {
        if (array.is_used(features_)) {
            device = placed(arena, host);
        }
    });
    view_.mesh_search = nullptr;
    if (tree_ != nullptr || has_normals()) {
        view_.mesh_search = arena.take<MeshSearch<Real>>(1);
        search_ = {};
    }
    if (tree_ != nullptr) {
        search_.objects = tree_->objects();
        search_.flat = tree_->flat();
    }
    if (has_normals()) {
        const ShadingNormals<Real>& normals = host_.mesh_search->normals;
        search_.normals = {placed(arena, normals.objects), placed(arena, normals.corners)};
    }
    view_.environment_map = nullptr;
    if (host_.environment_map != nullptr) {
        view_.environment_map = arena.take<EnvironmentMap<Real>>(1);
        environment_map_ = *host_.environment_map;
        environment_map_.rows = placed(arena, environment_map_.rows);
        environment_map_.texels = placed(arena, environment_map_.texels);
    }
    view_.adjoint = nullptr;
    if (host_.adjoint != nullptr) {
        view_.adjoint = arena.take<AdjointCache<Real>>(1);
        adjoint_ = *host_.adjoint;
        adjoint_.by_place = placed(arena, adjoint_.by_place);
        adjoint_.by_segment = placed(arena, adjoint_.by_segment);
        adjoint_.by_pixel = placed(arena, adjoint_.by_pixel);
    }
    instances_.assign(host_.meshes.data, host_.meshes.data + host_.meshes.size);
    for (std::size_t i = 0; i < instances_.size(); ++i) {
        const float* const light_areas = instances_[i].geometry.cumulative_area;
        instances_[i].geometry = device_meshes_.at(i)->view();
        if (light_areas == nullptr) {
            instances_[i].geometry.cumulative_area = nullptr;
        }
    }
}

template <class Real>
void DeviceScene<Real>::upload(const Module& module, cudaStream_t stream) const {
    for_each_array(view_, host_, [&](const SceneArray& array, const auto& device, const auto& host) {
        if (array.is_used(features_)) {
            copy_to_device(device, host, stream);
        }
    });
    SceneView<Real> host = host_;
    host.meshes = {instances_.data(), static_cast<std::uint32_t>(instances_.size())};
    copy_to_device(view_.meshes, host.meshes, stream);
    if (view_.mesh_search != nullptr) {
        copy_to_device(View<MeshSearch<Real>>{view_.mesh_search, 1}, View<MeshSearch<Real>>{&search_, 1}, stream);
    }
    if (has_normals()) {
        copy_to_device(search_.normals.objects, host_.mesh_search->normals.objects, stream);
        copy_to_device(search_.normals.corners, host_.mesh_search->normals.corners, stream);
    }
    if (host_.environment_map != nullptr) {
        copy_to_device(environment_map_.rows, host_.environment_map->rows, stream);
        copy_to_device(environment_map_.texels, host_.environment_map->texels, stream);
        copy_to_device(View<EnvironmentMap<Real>>{view_.environment_map, 1}, {&environment_map_, 1}, stream);
    }
    if (host_.adjoint != nullptr) {
        copy_to_device(adjoint_.by_place, host_.adjoint->by_place, stream);
        copy_to_device(adjoint_.by_segment, host_.adjoint->by_segment, stream);
        copy_to_device(adjoint_.by_pixel, host_.adjoint->by_pixel, stream);
        copy_to_device(View<AdjointCache<Real>>{view_.adjoint, 1}, {&adjoint_, 1}, stream);
    }
    const std::vector<unsigned char> constant = constant_scene(host, features_);
    if (!is_baked_ && !constant.empty() && constant.size() <= constant_bytes) {
        PT_CUDA_CHECK(cudaMemcpyAsync(module.global("pt_scene"), constant.data(), constant.size(),
                                      cudaMemcpyHostToDevice, stream));
    }
    PT_CUDA_CHECK(cudaStreamSynchronize(stream));  // waits until the local array `constant` has been copied
}

template std::string scene_place(const SceneView<float>& scene, FeatureSet features, bool is_baked);
template std::string scene_place(const SceneView<double>& scene, FeatureSet features, bool is_baked);
template void fix_counts(const SceneView<float>& scene, KernelConfig& config);
template void fix_counts(const SceneView<double>& scene, KernelConfig& config);
template std::string baked_text(const SceneView<float>& scene);
template std::string baked_text(const SceneView<double>& scene);
template class DeviceScene<float>;
template class DeviceScene<double>;

}  // namespace pt::cuda
