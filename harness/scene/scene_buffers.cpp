#include "harness/scene/scene_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "harness/scene/find_enclosure.h"
#include "harness/scene/guide_walks.h"
#include "harness/scene/material_kind.h"
#include "kernels/adjoint.h"
#include "kernels/scene_arrays.h"

namespace pt {

namespace {

std::array<double, 3> as_array(const Vec3d& v) { return {v.x, v.y, v.z}; }

auto canonical_key(const Scene& scene, const SceneObject& object) {
    const std::string mesh_hash = object.mesh != SceneObject::no_mesh
                                      ? scene.meshes[object.mesh]->hash + scene.meshes[object.mesh]->coordinates_hash +
                                            (object.shading_normals ? scene.meshes[object.mesh]->normals_hash : "")
                                      : "";
    return std::make_tuple(classify(object), as_array(object.translate), as_array(object.rotate_degrees),
                           as_array(object.scale), as_array(object.velocity), object.material, mesh_hash);
}

template <class Real>
void guide_bodies(std::vector<Material<Real>>& materials, const Scene& scene, double guided_share) {
    for (std::uint32_t index = 0; index < materials.size(); ++index) {
        if (materials[index].type != MaterialType::subsurface) {
            continue;
        }
        double depth = std::numeric_limits<double>::infinity();
        for (const SceneObject& object : scene.objects) {
            depth = object.material == index ? std::min(depth, depth_of(object)) : depth;
        }
        guide_walks(materials[index].subsurface.medium, scene.materials[index], guided_share, depth);
    }
}

// The medium that camera rays start in: the smallest dielectric around the camera's eye, if it absorbs.
std::uint32_t medium_at_eye(const Scene& scene) {
    std::uint32_t medium = Path<float>::no_medium;
    double least_volume = std::numeric_limits<double>::infinity();
    for (const SceneObject& object : scene.objects) {
        const SceneMaterial& material = scene.materials[object.material];
        const double volume = object.scale.x * object.scale.y * object.scale.z;
        if (lets_light_in(material) && volume < least_volume && contains_point(scene, object, scene.camera.eye)) {
            least_volume = volume;
            medium = material.sigma_a != Vec3d(0.0) ? object.material : Path<float>::no_medium;
        }
    }
    return medium;
}

template <class Real>
Camera<Real> make_camera(const Scene& scene, const RenderSettings& settings) {
    const SceneCamera& c = scene.camera;
    const Vec3d forward = normalize(c.look_at - c.eye);
    const Vec3d right = normalize(cross(forward, c.up));
    const Vec3d up = cross(right, forward);
    Camera<Real> camera{};
    camera.right = narrow<Real>(right);
    camera.up = narrow<Real>(up);
    camera.forward = narrow<Real>(forward);
    camera.width = settings.width;
    camera.height = settings.height;
    camera.pixel_size =
        static_cast<Real>(2.0 * std::tan(c.vertical_fov_degrees * pi<double> / 360.0) / settings.height);
    camera.aperture_radius = static_cast<Real>(c.aperture_radius);
    camera.focus_distance = static_cast<Real>(c.focus_distance);
    camera.shutter_open = static_cast<Real>(c.shutter_open);
    camera.shutter_length = static_cast<Real>(c.shutter_close - c.shutter_open);
    camera.shutter_late = c.shutter_late ? 1 : 0;
    camera.jitter = c.jitter ? 1 : 0;
    camera.initial_medium = medium_at_eye(scene);
    return camera;
}

// Sets what a shape's constructor cannot know from its placement: for a sphere near the camera's eye, its `eye_power`,
// computed from the scene file's numbers before any is rounded.
template <class Shape>
void complete(Shape&, const SceneObject&, const Vec3d&) {}
template <class Real>
void complete(Sphere<Real>& sphere, const SceneObject& object, const Vec3d& eye) {
    if (is_near_eye(object, eye)) {
        sphere.eye_power = static_cast<Real>(eye_power(object, eye));
        sphere.is_near_eye = 1;
    }
}

template <class Shape>
auto in_double(const Shape& shape) {
    if constexpr (requires { widened(shape); }) {
        return widened(shape);
    } else {
        return shape;
    }
}

// Emitting surface area of a light, both sides of a flat shape included. An ellipsoid's is approximate: exact for a
// sphere, 16 % too large for a disc.
template <class Shape>
double emitting_area(const Shape& shape) {
    if constexpr (requires { area_of(shape); }) {
        return area_of(shape) * (Shape::is_flat ? 2 : 1);
    } else if constexpr (requires { shape.area; }) {
        return static_cast<double>(shape.area);
    } else {
        const auto square = [&](int i) { return dot(shape.semi_axis[i], shape.semi_axis[i]); };
        const double mean = (square(0) * square(1) + square(1) * square(2) + square(2) * square(0)) / 3;
        return 4 * pi<double> * std::sqrt(mean);
    }
}

// Projected area of a light along each axis. Boxes and quads: the sum over the faces of their area times |normal|.
// Spheres: two thirds of the disc, since |x| + |y| + |z| of a direction is 3/2 in the mean. Other shapes count as
// spheres of the same surface.
template <class Shape>
Vec3d shown_area(const Shape& shape, const Placement& placement) {
    const auto face = [&](int axis, double first, double second) {
        const Vec3d& normal = placement.column[axis];
        return Vec3d(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)) * (first * second);
    };
    const Vec3d& size = placement.scale;
    if constexpr (Shape::unit_shape == UnitShape::box) {
        return face(0, size.y, size.z) + face(1, size.z, size.x) + face(2, size.x, size.y);
    } else if constexpr (Shape::unit_shape == UnitShape::quad) {
        return face(1, size.z, size.x);
    } else if constexpr (Shape::unit_shape == UnitShape::sphere) {
        const Vec3d discs[] = {face(0, size.y, size.z), face(1, size.z, size.x), face(2, size.x, size.y)};
        Vec3d shown;
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3d along{discs[0][axis], discs[1][axis], discs[2][axis]};
            shown[axis] = pi<double> / 6 * std::sqrt(dot(along, along));
        }
        return shown;
    } else {
        return Vec3d(emitting_area(shape) / 6);
    }
}

template <class Shape>
LightExtent extent_of(const Shape& shape, const Scene& scene, const SceneObject& object, const Placement& placement) {
    Bounds<double> bounds = bounds_of(shape);
    const double times[] = {scene.camera.shutter_open, scene.camera.shutter_close};
    const Bounds<double> at_rest = bounds;
    for (int axis = 0; axis < 3; ++axis) {
        const double moved[] = {object.velocity[axis] * times[0], object.velocity[axis] * times[1]};
        bounds.low[axis] = at_rest.low[axis] + std::min(moved[0], moved[1]);
        bounds.high[axis] = at_rest.high[axis] + std::max(moved[0], moved[1]);
    }
    const Vec3d& emission = scene.materials[object.material].emission;
    const double radiance = (emission.x + emission.y + emission.z) / 3;
    return {bounds, emitting_area(shape) * radiance, shown_area(shape, placement) * radiance};
}

template <class Real>
Transform<Real> make_transform(const SceneObject& object, const Placement& placement, UnitShape shape) {
    Transform<Real> transform{};
    for (int axis = 0; axis < 3; ++axis) {
        // A flat shape has no thickness, so its scale along its normal is arbitrary and set to 1.
        const double scale = is_flat(object) && axis == 1 ? 1.0 : object.scale[axis];
        const Vec3d& column = placement.column[axis];
        transform.row[axis] = narrow<Real>(column / scale);
        transform.offset[axis] = static_cast<Real>(-dot(column, placement.centre) / scale);
        transform.column[axis] = narrow<Real>(column * scale);
    }
    transform.centre = narrow<Real>(placement.centre);
    transform.shape = shape;
    return transform;
}

// Checks that the list PT_SCENE_ARRAYS has every array of SceneView: an array missing from the list would stay empty.
#define PT_COUNT(...) +1
static_assert(offsetof(SceneView<float>, environment) == (0 PT_SCENE_ARRAYS(PT_COUNT)) * sizeof(View<Light>));
#undef PT_COUNT

template <class T>
View<T> view_of(const std::vector<T>& values) {
    return {values.data(), static_cast<std::uint32_t>(values.size())};
}

// Appends values to an array and returns the index that the first value has there.
template <class T>
std::uint32_t append(std::vector<T>& array, const std::vector<T>& values) {
    const auto first = static_cast<std::uint32_t>(array.size());
    array.insert(array.end(), values.begin(), values.end());
    return first;
}

// Images whose texels are in the scene's texel array already, so that each image is stored once.
class PlacedImages {
public:
    explicit PlacedImages(std::vector<Vec3<float>>& texels) : texels_(texels) {}

    TexelBlock place(const SceneTexture* texture) {
        if (texture == nullptr) {
            return {0, 0, 0};
        }
        const auto [first, is_new] = first_texel_.try_emplace(texture, 0);
        if (is_new) {
            first->second = append(texels_, texture->image.texels);
        }
        return {texture->image.width, texture->image.height, first->second};
    }

private:
    std::vector<Vec3<float>>& texels_;
    std::map<const SceneTexture*, std::uint32_t> first_texel_;
};

}  // namespace

FeatureSet shortcuts_of(const Scene& scene) {
    return SceneBuffers<float>(scene, default_settings(scene)).view().enclosure.walls != 0
               ? static_cast<FeatureSet>(Feature::enclosure)
               : no_features;
}

RenderSettings default_settings(const Scene& scene) {
    return {scene.camera.width, scene.camera.height, scene.max_depth, 0, false};
}

template <class Real>
void SceneBuffers<Real>::complete(MeshInstance<Real>& instance, const Scene& scene, const SceneObject& object,
                                  const Placement& placement, const Acceleration& acceleration) {
    const std::shared_ptr<const SceneMesh>& mesh = scene.meshes[object.mesh];
    // A light's mesh is always placed, since a light sample picks a triangle by its area in scene space, which a
    // non-uniform scale changes from triangle to triangle.
    const bool is_light = scene.materials[object.material].emission != Vec3d(0.0);
    instance.is_placed = shown_by_[object.mesh] == 1 || is_light ? 1 : 0;
    meshes_.push_back(geometry_of(mesh, instance.is_placed != 0 ? &placement : nullptr, acceleration));
    const MeshGeometry& geometry = meshes_.back();
    instance.geometry = geometry.view();
    if (!is_light) {
        instance.geometry.cumulative_area = nullptr;
    }
    const Box bounds = instance.is_placed != 0 ? geometry.placed->bounds : box_round(*mesh, placement);
    for (int axis = 0; axis < 3; ++axis) {
        instance.low[axis] = bounds.low[axis];
        instance.high[axis] = bounds.high[axis];
    }
    instance.area = is_light ? static_cast<float>(geometry.placed->area) : 0.0f;
}

template <class Real>
void SceneBuffers<Real>::add_object(const Scene& scene, std::uint32_t index, const Acceleration& acceleration) {
    const SceneObject& object = scene.objects[index];
    const Placement placement = placement_of(object, scene.camera.eye);
    switch (classify(object)) {
#define PT_ADD_SHAPE(name, array, Type)                                                                \
    case ShapeKind::name:                                                                              \
        arrays_.array.push_back(Type<Real>::placed(placement));                                        \
        if constexpr (ShapeKind::name == ShapeKind::mesh) {                                            \
            complete(arrays_.meshes.back(), scene, object, placement, acceleration);                   \
        } else {                                                                                       \
            pt::complete(arrays_.array.back(), object, scene.camera.eye);                              \
        }                                                                                              \
        arrays_.transforms.push_back(make_transform<Real>(object, placement, Type<Real>::unit_shape)); \
        break;
        PT_SHAPES(PT_ADD_SHAPE)
#undef PT_ADD_SHAPE
    }
    if (scene.materials[object.material].emission != Vec3d(0.0)) {
        arrays_.lights.push_back({static_cast<std::uint32_t>(arrays_.object_material.size())});
        switch (classify(object)) {
#define PT_EXTENT(name, array, Type)                                                                    \
    case ShapeKind::name:                                                                               \
        light_extents_.push_back(extent_of(in_double(arrays_.array.back()), scene, object, placement)); \
        break;
            PT_SHAPES(PT_EXTENT)
#undef PT_EXTENT
        }
    }
    arrays_.object_material.push_back(object.material);
    arrays_.velocity.push_back(narrow<Real>(object.velocity));
    file_index_.push_back(index);
}

template <class Real>
SceneBuffers<Real>::SceneBuffers(const Scene& scene, const RenderSettings& settings, const Acceleration& acceleration) {
    using Key = decltype(canonical_key(scene, scene.objects.front()));
    std::vector<Key> keys;
    shown_by_.resize(scene.meshes.size());
    for (const SceneObject& object : scene.objects) {
        keys.push_back(canonical_key(scene, object));
        if (object.mesh != SceneObject::no_mesh) {
            ++shown_by_[object.mesh];
        }
    }
    std::vector<std::uint32_t> order(scene.objects.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
    for (const std::uint32_t index : order) {
        add_object(scene, index, acceleration);
    }
    for (const SceneMaterial& material : scene.materials) {
        arrays_.materials.push_back(packed<Real>(material));
    }
    for (const std::uint32_t index : arrays_.object_material) {
        const SceneMaterial& material = scene.materials[index];
        arrays_.surfaces.push_back({narrow<Real>(kind_of(material).surface_colour(material)), material.type});
    }
    if (settings.guided_share > 0) {
        guide_bodies(arrays_.materials, scene, settings.guided_share);
    }
    if (has_textures(scene)) {
        make_textures(scene);
    }
    if (contains(features_of(scene), Feature::shading_normals)) {
        make_normals(scene);
    }
    if (settings.light_selection != LightSelection::uniform && !arrays_.lights.empty()) {
        make_light_tables();
    }
    for_each_array(view_, arrays_, [](const SceneArray&, auto& view, const auto& values) { view = view_of(values); });
    view_.environment = narrow<Real>(scene.environment);
    if (scene.environment_map != nullptr) {
        environment_ =
            environment_table<Real>(*scene.environment_map, static_cast<std::uint32_t>(arrays_.lights.size()),
                                    settings.light_selection == LightSelection::uniform);
    }
    view_.environment_map = environment_ != nullptr ? &environment_->map : nullptr;
    view_.camera = make_camera<Real>(scene, settings);
    view_.seed = RandomSeed::from(settings.seed);
    view_.depth = settings.depth;
    view_.seed.sampler = settings.sampler;
    view_.final_bounce = settings.final_bounce ? 1 : 0;
    // Emitters of zero radiance are not in the list of lights, so a scene may have no light for next-event estimation.
    view_.next_event = settings.next_event && (!arrays_.lights.empty() || environment_ != nullptr) ? 1 : 0;
    view_.mis_exponent = settings.mis_exponent;
    view_.light_sampling = settings.light_sampling;
    view_.near_light = settings.near_light;
    view_.light_selection = settings.light_selection;
    view_.one_sample = settings.one_sample ? 1 : 0;
    view_.roulette_start = settings.roulette_start;
    view_.adjoint = nullptr;
    view_.enclosure = find_enclosure(view_);
    make_search(acceleration);
}

// Stores each texture image once, and each mesh's texture coordinates once, however many objects show them.
template <class Real>
void SceneBuffers<Real>::make_textures(const Scene& scene) {
    PlacedImages images(arrays_.texels);
    std::map<std::uint32_t, std::uint32_t> first_coordinate;
    for (std::size_t number = 0; number < file_index_.size(); ++number) {
        const SceneObject& object = scene.objects[file_index_[number]];
        const SceneMaterial& material = scene.materials[object.material];
        const SceneTexture* const roughness =
            kind_of(material).ignores_roughness(material) ? nullptr : material.roughness_texture.get();
        ObjectTexture<Real> shown{arrays_.transforms[number], images.place(material.texture.get()),
                                  images.place(roughness), 0};
        if (shows_images(material) && object.mesh != SceneObject::no_mesh) {
            const auto [coordinates, is_new] = first_coordinate.try_emplace(object.mesh, 0);
            if (is_new) {
                coordinates->second = append(arrays_.texture_coordinates, scene.meshes[object.mesh]->coordinates);
            }
            shown.first_coordinate = coordinates->second;
        }
        arrays_.object_textures.push_back(shown);
    }
}

// Stores each normal map once, and each mesh's vertex normals once.
template <class Real>
void SceneBuffers<Real>::make_normals(const Scene& scene) {
    PlacedImages images(arrays_.texels);
    std::map<std::uint32_t, std::uint32_t> first_normal;
    for (const std::uint32_t index : file_index_) {
        const SceneObject& object = scene.objects[index];
        const SceneMaterial& material = scene.materials[object.material];
        const Placement placement = placement_of(object, scene.camera.eye);
        const double least = std::min({object.scale.x, object.scale.y, object.scale.z});
        ObjectNormals<Real> normals{};
        for (int axis = 0; axis < 3; ++axis) {
            normals.row[axis] = narrow<Real>(placement.column[axis] * (least / object.scale[axis]));
        }
        normals.first_normal = ObjectNormals<Real>::none;
        if (object.shading_normals) {
            const auto [first, is_new] = first_normal.try_emplace(object.mesh, 0);
            if (is_new) {
                first->second = append(corner_normals_, scene.meshes[object.mesh]->normals);
            }
            normals.first_normal = first->second;
        }
        normals.map = images.place(material.normal_texture.get());
        normals.map_scale = static_cast<Real>(material.normal_scale);
        object_normals_.push_back(normals);
    }
}

template <class Real>
void SceneBuffers<Real>::make_light_tables() {
    LightTables<Real> tables = light_tables<Real>(light_extents_);
    arrays_.light_slots = std::move(tables.slots);
    arrays_.light_nodes = std::move(tables.nodes);
    arrays_.object_light.resize(arrays_.object_material.size());
    for (std::uint32_t light = 0; light < arrays_.lights.size(); ++light) {
        arrays_.object_light[arrays_.lights[light].object] = light;
    }
}

template <class Real>
void SceneBuffers<Real>::make_search(const Acceleration& acceleration) {
    tree_ = scene_tree_of(view_, meshes_, acceleration);
    const AcceleratorHook& accelerator = acceleration.accelerator_hook;
    const LevelsHook& levels = acceleration.levels_hook;
    MeetMeshes<Real> meet_meshes = nullptr;
    if constexpr (std::is_same_v<Real, float>) {
        search_.meet_mesh = accelerator.meet_single;
        meet_meshes = levels.is_flat ? accelerator.meet_flat_single : levels.meet_single;
    } else {
        search_.meet_mesh = accelerator.meet_double;
        meet_meshes = levels.is_flat ? accelerator.meet_flat_double : levels.meet_double;
    }
    if (tree_ != nullptr) {
        search_.meet_meshes = meet_meshes;
        search_.objects = tree_->objects_view();
        search_.flat = tree_->flat_view();
    }
    search_.normals = {view_of(object_normals_), view_of(corner_normals_)};
    view_.mesh_search = &search_;
}

namespace {

double brightest_channel(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

double gain_of(const Scene& scene) {
    double gain = 1;
    for (const SceneMaterial& material : scene.materials) {
        gain = std::max(gain, kind_of(material).largest_gain(material));
    }
    return gain;
}

// Upper bound on a sample's radiance from emitters that its path hits and from an environment not light-sampled.
double bound_on_sources(const Scene& scene, std::uint32_t depth) {
    double brightest = brightest_channel(scene.environment);
    double brightest_reflector = 0;
    double albedo = 0;
    for (const SceneMaterial& material : scene.materials) {
        brightest = std::max(brightest, brightest_channel(material.emission));
        if (!has_trait(material.type, material_trait::ends_paths)) {
            brightest_reflector = std::max(brightest_reflector, brightest_channel(material.emission));
        }
        const double grazing = kind_of(material).reflects_all_at_grazing ? 1 : 0;
        albedo =
            std::max({albedo, brightest_channel(material.albedo), brightest_channel(material.reflectance), grazing});
    }
    // A path can hit emitters again only if they reflect: their share is a geometric series, cut off at the path depth.
    const double series =
        albedo < 1 ? std::min(1 / (1 - albedo), static_cast<double>(depth)) : static_cast<double>(depth);
    return (brightest + brightest_reflector * series) * gain_of(scene);
}

// Upper bound on the radiance from an environment that is light-sampled. The contribution of a light sample goes with
// the mean over all directions, as sampling is in proportion to radiance, so a bright sun costs the film no precision.
double bound_on_environment(const Scene& scene, double room) {
    if (scene.environment_map == nullptr) {
        return 0;
    }
    const EnvironmentImage& image = scene.environment_map->image;
    double most = 0, mean = 0;
    for (std::uint32_t row = 0; row < image.height; ++row) {
        const auto cosine = [&](std::uint32_t border) { return sin_cos_turn(border / (2.0 * image.height)).cosine; };
        const double share = (cosine(row) - cosine(row + 1)) / (2.0 * image.width);
        for (std::uint32_t column = 0; column < image.width; ++column) {
            const double light = brightest_channel(Vec3d(image.texels[std::size_t{row} * image.width + column]));
            most = std::max(most, light);
            mean += light * share;
        }
    }
    return std::max(most, mean * room) * gain_of(scene);
}

}  // namespace

double radiance_bound(const Scene& scene, const RenderSettings& settings) {
    const double room = settings.final_bounce || settings.next_event || settings.guided_share > 0 ? 1024 : 1;
    const double carried = settings.adjoint.paths != 0 ? most_carried<double> : 1;
    const double bound = std::max(bound_on_sources(scene, settings.depth) * room, bound_on_environment(scene, room));
    return (bound > 0 ? bound : room) * carried;
}

double radiance_bound(const Scene& scene, std::uint32_t depth) {
    const double bound = std::max(bound_on_sources(scene, depth), bound_on_environment(scene, 1));
    return bound > 0 ? bound : 1;
}

template class SceneBuffers<float>;
template class SceneBuffers<double>;

}  // namespace pt
