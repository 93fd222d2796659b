// A scene as its file says it, validated, in double precision. Lengths in scene units, angles in degrees, velocity in
// units a second, sigma in 1/unit, radiance linear RGB.
#pragma once

#include <any>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "harness/scene/environment_image.h"
#include "harness/scene/texture_image.h"
#include "kernels/material_list.h"
#include "kernels/shapes.h"
#include "variants/bvh/binary_tree.h"

namespace pt {

using Vec3d = Vec3<double>;

inline bool is_black(const Vec3d& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

struct SceneCamera {
    Vec3d eye{}, look_at{}, up{};
    double vertical_fov_degrees = 0;
    std::uint32_t width = 0, height = 0;
    bool jitter = true;
    double aperture_radius = 0;
    double focus_distance = 1;
    double shutter_open = 0, shutter_close = 0;
    bool shutter_late = false;
};

// An image that surfaces show.
struct SceneTexture {
    TextureImage image;
    std::string file;  // as the scene names it
    std::string path;  // where it lies
    std::string hash;  // of the texels and the width: 16 hex digits
};

struct SceneMaterial {
    std::string name;
    MaterialType type = MaterialType::diffuse;
    Vec3d albedo{0.0}, emission{0.0}, reflectance{0.0}, tint{1.0}, sigma_a{0.0}, sigma_s{0.0};
    // The image in place of the albedo (diffuse, mix; principled: its base colour) or the reflectance (mirror,
    // rough_conductor), which then has the largest of its texels in each channel. Null: one colour.
    std::shared_ptr<const SceneTexture> texture;
    double mirror_probability = 0;
    double roughness = 0;
    // The image in place of the roughness, which then has the largest of its texels. Null: one number.
    std::shared_ptr<const SceneTexture> roughness_texture;
    // The image of normals in tangent space, and the factor of their first two components. Null: the surface's own.
    std::shared_ptr<const SceneTexture> normal_texture;
    double normal_scale = 1;
    bool multiple_scattering = false;
    double metallic = 0, transmission = 0;  // principled
    std::any own;  // what its kind alone has, of a type that is known in the kind's file (harness/scene/materials/)
    double ior = 1;
    double g = 0;
    std::uint32_t max_scatterings = 1000000;
};

// A shape as scene files name it, by the first of the kinds that share the name.
struct Shape {
    ShapeKind first_kind;

    static const Shape sphere, box, quad, mesh;
    bool operator==(const Shape& other) const { return first_kind == other.first_kind; }
};
inline constexpr Shape Shape::sphere{ShapeKind::sphere};
inline constexpr Shape Shape::box{ShapeKind::axis_box};
inline constexpr Shape Shape::quad{ShapeKind::quad};
inline constexpr Shape Shape::mesh{ShapeKind::mesh};

// A mesh that objects show. Its triangles stand in an order that does not depend on the file's: each begins with its
// least vertex, and they are sorted, so that no film depends on the order either.
struct SceneMesh {
    std::string source;  // as the scene names it: a file, or a generator and its size
    std::vector<Triangle<float>> triangles;
    std::uint32_t degenerate_left_out = 0;
    std::vector<std::string> warnings;  // "PLACE: TEXT": what its file has that is not read as it stands
    Box bounds;
    bool is_closed = false;                      // every edge is shared by two triangles, in opposite directions
    std::string hash;                            // of the triangles: 16 hex digits
    std::vector<CornerCoordinates> coordinates;  // by triangle; empty: none
    std::string coordinates_hash;                // of them: 16 hex digits; empty: there are none
    std::vector<CornerNormals> normals;          // by triangle; empty: none were asked for, or they have a fault
    std::string normals_hash;                    // of them: 16 hex digits; empty: there are none
    std::string normals_fault;                   // why there are none where they were asked for
};

struct SceneObject {
    static constexpr std::uint32_t no_mesh = 0xffffffffu;

    Shape shape = Shape::sphere;
    std::uint32_t mesh = no_mesh;  // index into Scene::meshes
    std::uint32_t material = 0;
    bool shading_normals = false;     // the mesh's, in place of its triangles'
    std::uint32_t index_in_file = 0;  // of $.objects; copies that a rule makes share it
    Vec3d translate{0.0}, rotate_degrees{0.0}, scale{1.0}, velocity{0.0};
};

// Light from all round that is drawn as lights are: an image, or one texel for one number.
struct SceneEnvironment {
    EnvironmentImage image;
    double rotation_degrees = 0;  // about y, as an object's
    std::string file;             // as the scene names it; empty: one number
    std::string hash;             // of the texels: 16 hex digits
};

struct Scene {
    std::string name;
    std::string file;  // that it was read from, with its whole path; empty: none
    std::string description;
    std::uint32_t max_depth = 1;
    Vec3d environment{0.0};                                   // light from all round that is met, never drawn
    std::shared_ptr<const SceneEnvironment> environment_map;  // null: none
    SceneCamera camera;
    std::vector<SceneMaterial> materials;  // sorted by name
    std::vector<SceneObject> objects;
    std::vector<std::shared_ptr<const SceneMesh>> meshes;
    std::string hash;  // of the file's content, white space and key order aside; 16 hex digits
};

// Reads and validates a scene. Throws InputError. `file` is for the messages.
Scene load_scene(const std::string& file);
Scene parse_scene(const std::string& text, const std::string& file);

// The names that scene files have for shapes, each once, and the shape that goes by one of them.
std::vector<std::string> shape_names();
Shape shape_named(const std::string& name);
std::string name_of(Shape shape);

Placement placement_of(const SceneObject& object, const Vec3d& eye);
// Which formula an object is intersected by.
ShapeKind classify(const SceneObject& object);
bool is_flat(const SceneObject& object);

// Whether light passes the material's surface by refraction.
bool lets_light_in(const SceneMaterial& material);
// Whether the material's colour, roughness or normal is an image.
bool shows_images(const SceneMaterial& material);
// Whether an object that the scene has shows an image.
bool has_textures(const Scene& scene);
// Whether the object is shaded with other normals than its surface's own; what only emits is not.
bool has_shading_normals(const Scene& scene, const SceneObject& object);

// Everything that rendering the scene needs, and nothing else.
FeatureSet features_of(const Scene& scene);

// Whether a point lies inside the object as it stands at time 0; never inside a flat shape or a mesh that is not
// closed.
bool contains_point(const Scene& scene, const SceneObject& object, const Vec3d& point);

// The power of the camera's eye with respect to a sphere, |centre - eye|^2 - radius^2, in square radii: to one rounding
// of a double from the numbers of the scene.
double eye_power(const SceneObject& sphere, const Vec3d& eye);
// Whether that is how the sphere is met best (NearSphere in kernels/shapes/sphere.h): the eye is off its surface by
// less than about a quarter of its radius. Not for objects of other kinds.
bool is_near_eye(const SceneObject& object, const Vec3d& eye);

// Columns of the rotation "about x, then y, then z"; exact at multiples of 90 degrees.
struct Rotation {
    Vec3d column[3];
};
Rotation rotation_of(const Vec3d& degrees);

}  // namespace pt
