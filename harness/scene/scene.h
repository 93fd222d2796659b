// A scene as its file describes it, validated, in double precision. Lengths in scene units, angles in degrees, velocity
// in units a second, sigma in 1/unit, radiance in linear RGB.
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

// A texture image that materials show.
struct SceneTexture {
    TextureImage image;
    std::string file;  // file name of the texture as the scene writes it
    std::string path;  // path of the texture file on disk
    std::string hash;  // hash of the texture's texels and width: 16 hex digits
};

struct SceneMaterial {
    std::string name;
    MaterialType type = MaterialType::diffuse;
    Vec3d albedo{0.0}, emission{0.0}, reflectance{0.0}, tint{1.0}, sigma_a{0.0}, sigma_s{0.0};
    // Texture in place of the albedo (diffuse, mix; principled: the base colour) or the reflectance (mirror,
    // rough_conductor). The colour itself is then the largest texel in each channel. Null: no texture.
    std::shared_ptr<const SceneTexture> texture;
    double mirror_probability = 0;
    double roughness = 0;
    // Texture in place of the roughness, which is then the largest texel. Null: no texture.
    std::shared_ptr<const SceneTexture> roughness_texture;
    // Normal map in tangent space, and the factor on the first two components of its normals. Null: no normal map.
    std::shared_ptr<const SceneTexture> normal_texture;
    double normal_scale = 1;
    bool multiple_scattering = false;
    double metallic = 0, transmission = 0;  // parameters of material kind principled
    std::any own;  // parameters of one kind of material, whose type only its file in harness/scene/materials/ knows
    double ior = 1;
    double g = 0;
    std::uint32_t max_scatterings = 1000000;
};

// A shape by its name in scene files. Several ShapeKinds can share a name; the first of them stands for all.
struct Shape {
    ShapeKind first_kind;

    static const Shape sphere, box, quad, mesh;
    bool operator==(const Shape& other) const { return first_kind == other.first_kind; }
};
inline constexpr Shape Shape::sphere{ShapeKind::sphere};
inline constexpr Shape Shape::box{ShapeKind::axis_box};
inline constexpr Shape Shape::quad{ShapeKind::quad};
inline constexpr Shape Shape::mesh{ShapeKind::mesh};

// A mesh that objects show. Triangles are in canonical order, so that no film depends on their order in the file: each
// triangle begins with its least vertex, and the triangles are sorted.
struct SceneMesh {
    std::string source;  // mesh file as the scene names it, or generator and size
    std::vector<Triangle<float>> triangles;
    std::uint32_t degenerate_left_out = 0;
    std::vector<std::string> warnings;  // "PLACE: TEXT" for each part of the mesh file that is not read as it stands
    Box bounds;
    bool is_closed = false;                      // whether each edge is shared by two triangles, in opposite directions
    std::string hash;                            // hash of the triangles: 16 hex digits
    std::vector<CornerCoordinates> coordinates;  // texture coordinates by triangle; empty: none
    std::string coordinates_hash;                // hash of texture coordinates: 16 hex digits; empty: none
    std::vector<CornerNormals> normals;          // vertex normals by triangle; empty: not asked for, or faulty
    std::string normals_hash;                    // hash of vertex normals: 16 hex digits; empty: none
    std::string normals_fault;                   // why the mesh has no vertex normals although they were asked for
};

struct SceneObject {
    static constexpr std::uint32_t no_mesh = 0xffffffffu;

    Shape shape = Shape::sphere;
    std::uint32_t mesh = no_mesh;  // index of the object's mesh in Scene::meshes
    std::uint32_t material = 0;
    bool shading_normals = false;     // whether the mesh's vertex normals are used in shading
    std::uint32_t index_in_file = 0;  // index of the object in $.objects; copies made by a rule share it
    Vec3d translate{0.0}, rotate_degrees{0.0}, scale{1.0}, velocity{0.0};
};

// An environment light that is sampled like other lights: an image, or one texel for a constant radiance.
struct SceneEnvironment {
    EnvironmentImage image;
    double rotation_degrees = 0;  // rotation of the image about y, in the same sense as an object's rotation
    std::string file;             // image file as the scene names it; empty: constant radiance
    std::string hash;             // hash of the environment's texels: 16 hex digits
};

struct Scene {
    std::string name;
    std::string file;  // absolute path of the scene file; empty: none
    std::string description;
    std::uint32_t max_depth = 1;
    Vec3d environment{0.0};                                   // constant environment radiance, never light-sampled
    std::shared_ptr<const SceneEnvironment> environment_map;  // environment that is light-sampled; null: none
    SceneCamera camera;
    std::vector<SceneMaterial> materials;  // materials sorted by name
    std::vector<SceneObject> objects;
    std::vector<std::shared_ptr<const SceneMesh>> meshes;
    std::string hash;  // hash of the file's content but for white space and key order; 16 hex digits
};

// Reads and validates a scene. Throws InputError. `file` is the name that error messages show.
Scene load_scene(const std::string& file);
Scene parse_scene(const std::string& text, const std::string& file);

// Conversion between shapes and their names in scene files; `shape_names` has each name once.
std::vector<std::string> shape_names();
Shape shape_named(const std::string& name);
std::string name_of(Shape shape);

Placement placement_of(const SceneObject& object, const Vec3d& eye);
// The kind of a shape, which decides the intersection formula.
ShapeKind classify(const SceneObject& object);
bool is_flat(const SceneObject& object);

// Whether light enters the material by refraction, as in glass; false for subsurface bodies.
bool lets_light_in(const SceneMaterial& material);
// Whether the material has a texture in place of its colour or roughness, or a normal map.
bool shows_images(const SceneMaterial& material);
// Whether any object of the scene has a material with a texture.
bool has_textures(const Scene& scene);
// Whether shading normals of the object differ from its geometric normals. Objects that only emit have none.
bool has_shading_normals(const Scene& scene, const SceneObject& object);

// Exactly the feature flags that rendering the scene needs.
FeatureSet features_of(const Scene& scene);

// Whether a point lies inside the object at time 0; never true for a flat shape or a mesh that is not closed.
bool contains_point(const Scene& scene, const SceneObject& object, const Vec3d& point);

// The power of the camera's eye with respect to a sphere, |centre - eye|^2 - radius^2, in units of radius^2, with the
// accuracy of a single double rounding.
double eye_power(const SceneObject& sphere, const Vec3d& eye);
// Whether a sphere is intersected more accurately with its `eye_power` (NearSphere in kernels/shapes/sphere.h): the eye
// is off its surface by less than about a quarter of its radius. Only for spheres.
bool is_near_eye(const SceneObject& object, const Vec3d& eye);

// Columns of the rotation matrix "about x, then y, then z"; exact at multiples of 90 degrees.
struct Rotation {
    Vec3d column[3];
};
Rotation rotation_of(const Vec3d& degrees);

}  // namespace pt
