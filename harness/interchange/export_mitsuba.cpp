#include "harness/interchange/export_mitsuba.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "harness/interchange/mitsuba_limits.h"
#include "harness/interchange/xml_text.h"
#include "harness/json_reader.h"
#include "harness/mesh/write_mesh.h"
#include "harness/scene/material_kind.h"

namespace pt {

namespace {

// The shortest text that parses to the same double; never "-0".
std::string number(double value) { return fmt::format("{}", value + 0.0); }

std::string triple(const Vec3d& v) { return fmt::format("{}, {}, {}", number(v.x), number(v.y), number(v.z)); }

// The affine map from a shape's own space to scene space, by the columns of its matrix.
struct Matrix {
    Vec3d x, y, z, origin;

    std::string text() const {
        std::string rows;
        for (int i = 0; i < 3; ++i) {
            rows += fmt::format("{} {} {} {} ", number(x[i]), number(y[i]), number(z[i]), number(origin[i]));
        }
        return rows + "0 0 0 1";
    }
};

// The largest coordinate difference between the camera's eye and any object's bounding box.
double reach_of(const Scene& scene) {
    double reach = 0;
    for (const SceneObject& object : scene.objects) {
        const Extent extent = extent_of(scene, object);
        for (int axis = 0; axis < 3; ++axis) {
            const double eye = scene.camera.eye[axis];
            reach = std::max({reach, std::abs(extent.low[axis] - eye), std::abs(extent.high[axis] - eye)});
        }
    }
    return reach > 0 ? reach : 1;
}

class Exporter {
public:
    Exporter(const Scene& scene, const MitsubaSettings& settings, const std::filesystem::path& out)
        : scene_(scene),
          settings_(settings),
          stem_(out.stem().string()),
          made_{.xml = "", .files = FilesBeside(out)},
          reach_(reach_of(scene) * settings.scale) {}

    MitsubaScene take() {
        xml_.open("scene", {{"version", "3.0.0"}});
        write_integrator();
        write_sensor();
        if (!is_black(scene_.environment)) {
            xml_.open("emitter", {{"type", "constant"}});
            rgb("radiance", scene_.environment);
            xml_.close();
        }
        if (scene_.environment_map != nullptr) {
            write_environment(*scene_.environment_map);
        }
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            if (is_shown(i)) {
                write_material(scene_.materials[i], i);
            }
        }
        write_groups();
        for (const SceneObject& object : scene_.objects) {
            write_object(object);
        }
        xml_.close();
        made_.xml = xml_.text();
        return std::move(made_);
    }

private:
    void value(const std::string& tag, const std::string& name, const std::string& text) {
        xml_.leaf(tag, {{"name", name}, {"value", text}});
    }
    void rgb(const std::string& name, const Vec3d& colour) { value("rgb", name, triple(colour)); }
    void real(const std::string& name, double x) { value("float", name, number(x)); }
    void whole(const std::string& name, std::uint64_t n) { value("integer", name, fmt::format("{}", n)); }

    bool is_shown(std::size_t material) const {
        return std::any_of(scene_.objects.begin(), scene_.objects.end(),
                           [&](const SceneObject& object) { return object.material == material; });
    }

    template <class Has>
    bool any_shown(const Has& has) const {
        return std::any_of(scene_.objects.begin(), scene_.objects.end(),
                           [&](const SceneObject& object) { return has(scene_.materials[object.material]); });
    }

    void write_integrator() {
        const bool has_walks =
            any_shown([](const SceneMaterial& m) { return has_trait(m.type, material_trait::has_walks); });
        const bool has_media = any_shown([](const SceneMaterial& m) { return !is_black(m.sigma_a); });
        // Mitsuba's volpathmis weights a medium's channels by their mean density, like subsurface walks in ptbench.
        xml_.open("integrator", {{"type", has_walks ? "volpathmis" : has_media ? "volpath" : "path"}});
        if (has_walks) {
            value("integer", "max_depth", "-1");
            whole("rr_depth", roulette_depth(scene_));
        } else {
            whole("max_depth", settings_.depth);
            whole("rr_depth", std::uint64_t{settings_.depth} + 1);  // Russian roulette starts beyond max_depth: never
        }
        xml_.close();
    }

    void write_sensor() {
        const SceneCamera& camera = scene_.camera;
        const bool has_lens = camera.aperture_radius > 0;
        xml_.open("sensor", {{"type", has_lens ? "thinlens" : "perspective"}});
        real("fov", camera.vertical_fov_degrees);
        value("string", "fov_axis", "y");
        if (has_lens) {
            real("aperture_radius", camera.aperture_radius * settings_.scale);
            real("focus_distance", camera.focus_distance * settings_.scale);
        }
        // Mitsuba's rays have a near and a far limit; ptbench's begin at the eye and have no end.
        real("near_clip", std::ldexp(reach_, -16));
        real("far_clip", std::ldexp(reach_, 3));
        xml_.open("transform", {{"name", "to_world"}});
        xml_.leaf("lookat", {{"origin", triple(camera.eye * settings_.scale)},
                             {"target", triple(camera.look_at * settings_.scale)},
                             {"up", triple(camera.up)}});
        xml_.close();
        xml_.open("film", {{"type", "hdrfilm"}});
        whole("width", settings_.width);
        whole("height", settings_.height);
        value("string", "pixel_format", "rgb");
        value("string", "component_format", "float32");
        xml_.leaf("rfilter", {{"type", "box"}});
        xml_.close();
        xml_.open("sampler", {{"type", "independent"}});
        whole("sample_count", settings_.samples);
        xml_.close();
        xml_.close();
    }

    // Enlarges an environment map by repeating its texels, since Mitsuba interpolates between texels and places the
    // first and last rows on the poles (src/emitters/envmap.cpp): small texels blur less. The larger map has one row
    // more than the repeated ones; a row between two rows of texels is their mean, so that neither row of texels grows.
    static EnvironmentImage enlarged(const EnvironmentImage& image) {
        constexpr std::uint32_t least_width = 2048, most_factor = 32;
        const std::uint32_t factor = std::clamp(least_width / image.width, 1u, most_factor);
        EnvironmentImage larger{image.width * factor, image.height * factor + 1, {}};
        for (std::uint32_t y = 0; y < larger.height; ++y) {
            const std::uint32_t below = std::min(y / factor, image.height - 1);
            const std::uint32_t above = y % factor == 0 && y > 0 ? y / factor - 1 : below;
            for (std::uint32_t x = 0; x < larger.width; ++x) {
                const auto texel = [&](std::uint32_t row) {
                    return image.texels[std::size_t{row} * image.width + x / factor];
                };
                larger.texels.push_back((texel(above) + texel(below)) * 0.5f);
            }
        }
        return larger;
    }

    void write_environment(const SceneEnvironment& environment) {
        if (environment.file.empty()) {
            xml_.open("emitter", {{"type", "constant"}});
            rgb("radiance", Vec3d(environment.image.texels.front()));
            xml_.close();
            return;
        }
        const auto name = [&](std::size_t n) {
            return fmt::format("{}_environment{}.exr", stem_, n == 0 ? "" : fmt::format("_{}", n));
        };
        const std::string file = made_.files.add(name, 0, encode_environment_exr(enlarged(environment.image)));
        xml_.open("emitter", {{"type", "envmap"}});
        value("string", "filename", file);
        xml_.open("transform", {{"name", "to_world"}});
        xml_.leaf("rotate", {{"y", "1"}, {"angle", number(environment.rotation_degrees)}});
        xml_.close();
        xml_.close();
    }

    // The id of a material in the XML, made of its number, since material names are free text.
    std::string id_of(std::size_t material) const { return fmt::format("material_{}", material); }

    std::string file_of(const SceneTexture& texture) {
        const auto [known, is_new] = image_files_.try_emplace(texture.path);
        if (is_new) {
            const auto name = [&](std::size_t n) {
                return fmt::format("{}_image_{}{}", stem_, n, ending_of(texture.path));
            };
            known->second = made_.files.add(name, made_.images++, read_file(texture.path, largest_texture_file));
        }
        return known->second;
    }

    // Mitsuba reads images as sRGB, as ptbench does. Its format "variant" keeps decoded texels in float, not in half.
    void write_image(const std::string& name, const SceneTexture& texture) {
        xml_.open("texture", {{"type", "bitmap"}, {"name", name}});
        value("string", "filename", file_of(texture));
        value("string", "filter_type", "bilinear");
        value("string", "wrap_mode", "repeat");
        value("boolean", "raw", "false");
        value("string", "format", "variant");
        xml_.close();
    }

    bool has_image(const SceneObject& object) const {
        return mitsuba_image(scene_.materials[object.material]) != nullptr;
    }

    // Writes a BSDF that reflects on both sides.
    void write_reflector(const std::string& id, const MitsubaBsdf& bsdf) {
        const bool is_mirror = bsdf.type == MitsubaBsdf::Type::conductor;
        xml_.open("bsdf", {{"type", "twosided"}, {"id", id}});
        xml_.open("bsdf", {{"type", is_mirror ? "conductor" : "diffuse"}});
        if (is_mirror) {
            value("string", "material", "none");
        }
        const std::string name = is_mirror ? "specular_reflectance" : "reflectance";
        if (bsdf.image != nullptr) {
            write_image(name, *bsdf.image);
        } else {
            rgb(name, bsdf.colour.value());
        }
        xml_.close();
        xml_.close();
    }

    void write_material(const SceneMaterial& material, std::size_t index) {
        const std::string id = id_of(index);
        const MitsubaBsdf bsdf = kind_of(material).in_mitsuba(material);
        if (bsdf.type == MitsubaBsdf::Type::none) {
            xml_.leaf("bsdf", {{"type", "null"}, {"id", id}});
        } else if (bsdf.type == MitsubaBsdf::Type::dielectric) {
            xml_.open("bsdf", {{"type", "dielectric"}, {"id", id}});
            real("int_ior", material.ior);
            real("ext_ior", 1);
            if (bsdf.colour) {
                rgb("specular_transmittance", *bsdf.colour);
            }
            xml_.close();
        } else {
            write_reflector(id, bsdf);
        }
    }

    void write_medium(const SceneMaterial& material) {
        const Vec3d sigma = material.sigma_a + material.sigma_s;
        if (is_black(sigma)) {
            return;
        }
        // Mitsuba's colours end at 1, so sigma_t is divided exactly, by a power of two, and "scale" multiplies it back.
        const double largest = std::exp2(std::ceil(std::log2(std::max({sigma.x, sigma.y, sigma.z}))));
        xml_.open("medium", {{"name", "interior"}, {"type", "homogeneous"}});
        rgb("sigma_t", sigma * (1 / largest));
        real("scale", largest / settings_.scale);
        Vec3d albedo(0.0);
        for (int i = 0; i < 3; ++i) {
            albedo[i] = sigma[i] > 0 ? material.sigma_s[i] / sigma[i] : 0;
        }
        rgb("albedo", albedo);
        if (!is_black(material.sigma_s)) {
            xml_.open("phase", {{"type", "hg"}});
            real("g", material.g);
            xml_.close();
        }
        xml_.close();
    }

    Matrix placement_of_object(const SceneObject& object) const {
        const Rotation rotation = rotation_of(object.rotate_degrees);
        const double k = settings_.scale;
        return {rotation.column[0] * (object.scale.x * k), rotation.column[1] * (object.scale.y * k),
                rotation.column[2] * (object.scale.z * k), place_of(scene_, object) * k};
    }

    void write_transform(const Matrix& matrix) {
        xml_.open("transform", {{"name", "to_world"}});
        xml_.leaf("matrix", {{"value", matrix.text()}});
        xml_.close();
    }

    // Writes what ends every shape element of Mitsuba's XML: BSDF reference, emitter and interior medium.
    void write_surface(const SceneObject& object) {
        const SceneMaterial& material = scene_.materials[object.material];
        xml_.leaf("ref", {{"name", "bsdf"}, {"id", id_of(object.material)}});
        if (is_emissive(material)) {
            // Mitsuba's emitters shine outwards: one around the camera's eye, such as a room, needs flipped normals.
            if (contains_as_it_stands(scene_, object, scene_.camera.eye)) {
                value("boolean", "flip_normals", "true");
            }
            xml_.open("emitter", {{"type", "area"}});
            rgb("radiance", material.emission * radiance_factor(scene_, object));
            xml_.close();
        }
        write_medium(material);
    }

    // Rotates a textured sphere to Mitsuba's parametrisation, where u is the angle about z from x on and v the angle
    // from z at the image's first row. In ptbench u is the angle about y from -z on, and the image's top is at +y.
    void write_sphere_with_image(const SceneObject& object) {
        const Matrix own = placement_of_object(object);
        xml_.open("shape", {{"type", "sphere"}});
        write_transform({own.z * -0.5, own.x * -0.5, own.y * 0.5, own.origin});
        write_surface(object);
        xml_.close();
    }

    void write_sphere(const SceneObject& object) {
        if (has_image(object)) {
            write_sphere_with_image(object);
            return;
        }
        const Vec3d centre = place_of(scene_, object) * settings_.scale;
        xml_.open("shape", {{"type", "sphere"}});
        xml_.leaf("point",
                  {{"name", "center"}, {"x", number(centre.x)}, {"y", number(centre.y)}, {"z", number(centre.z)}});
        real("radius", 0.5 * object.scale.x * settings_.scale);
        write_surface(object);
        xml_.close();
    }

    // Writes a box as Mitsuba's cube, whose side is 2.
    void write_box(const SceneObject& object) {
        const Matrix own = placement_of_object(object);
        xml_.open("shape", {{"type", "cube"}});
        write_transform({own.x * 0.5, own.y * 0.5, own.z * 0.5, own.origin});
        write_surface(object);
        xml_.close();
    }

    // Writes a rectangle, which in Mitsuba has side 2, lies in the plane xy and faces +z.
    void write_rectangle(const SceneObject& object, bool faces_up, const Vec3d& offset) {
        const Matrix own = placement_of_object(object);
        const double sign = faces_up ? 1 : -1;
        xml_.open("shape", {{"type", "rectangle"}});
        write_transform({own.x * 0.5, own.z * (-0.5 * sign), own.y * (0.5 * sign), own.origin + offset});
        write_surface(object);
        xml_.close();
    }

    // Writes a quad. A textured one is turned face down, as Mitsuba has an image's first row at the opposite edge; both
    // sides of a quad look alike. An emitting one becomes two rectangles back to back, slightly apart, as Mitsuba's
    // rectangles emit on one side only.
    void write_quad(const SceneObject& object) {
        if (!is_emissive(scene_.materials[object.material])) {
            write_rectangle(object, !has_image(object), Vec3d(0.0));
            return;
        }
        const Extent extent = extent_of(scene_, object);
        double farthest = reach_;
        for (int axis = 0; axis < 3; ++axis) {
            farthest = std::max({farthest, std::abs(extent.low[axis]) * settings_.scale,
                                 std::abs(extent.high[axis]) * settings_.scale});
        }
        const Vec3d half_gap = rotation_of(object.rotate_degrees).column[1] * std::ldexp(farthest, -17);
        write_rectangle(object, true, half_gap);
        write_rectangle(object, false, half_gap * -1.0);
    }

    std::string file_of(std::uint32_t mesh) {
        const auto [known, is_new] = mesh_files_.try_emplace(mesh);
        if (is_new) {
            const auto name = [&](std::size_t n) { return fmt::format("{}_mesh_{}.ply", stem_, n); };
            known->second = made_.files.add(name, mesh, ply_of(indexed_mesh(*scene_.meshes[mesh])));
            made_.meshes += 1;
        }
        return known->second;
    }

    // Mitsuba's v is 0 at an image's first row and ptbench's is 1, so v is flipped.
    void write_mesh_file(const SceneObject& object) {
        value("string", "filename", file_of(object.mesh));
        value("boolean", "face_normals", "true");
        if (has_image(object)) {
            value("boolean", "flip_tex_coords", "true");
        }
    }

    // Index of a mesh and of a material that several objects share, which are exported as instances of one shape group.
    using Group = std::pair<std::uint32_t, std::uint32_t>;
    static std::string id_of(const Group& group) { return fmt::format("mesh_{}_{}", group.first, group.second); }

    // Whether an object is exported as an instance; Mitsuba's emitters cannot be instances.
    bool is_instance(const SceneObject& object) const {
        const auto copies = copies_.find({object.mesh, object.material});
        return copies != copies_.end() && copies->second > 1 && !is_emissive(scene_.materials[object.material]);
    }

    void write_groups() {
        for (const SceneObject& object : scene_.objects) {
            if (object.mesh != SceneObject::no_mesh) {
                copies_[{object.mesh, object.material}] += 1;
            }
        }
        std::map<Group, bool> written;
        for (const SceneObject& object : scene_.objects) {
            const Group group{object.mesh, object.material};
            if (!is_instance(object) || written[group]) {
                continue;
            }
            written[group] = true;
            xml_.open("shape", {{"type", "shapegroup"}, {"id", id_of(group)}});
            xml_.open("shape", {{"type", "ply"}});
            write_mesh_file(object);
            write_surface(object);
            xml_.close();
            xml_.close();
        }
    }

    void write_mesh(const SceneObject& object) {
        const bool instance = is_instance(object);
        xml_.open("shape", {{"type", instance ? "instance" : "ply"}});
        if (instance) {
            xml_.leaf("ref", {{"id", id_of(Group{object.mesh, object.material})}});
        } else {
            write_mesh_file(object);
        }
        write_transform(placement_of_object(object));
        if (!instance) {
            write_surface(object);
        }
        xml_.close();
    }

    void write_object(const SceneObject& object) {
        if (object.mesh != SceneObject::no_mesh) {
            write_mesh(object);
        } else if (object.shape == Shape::sphere) {
            write_sphere(object);
        } else if (object.shape == Shape::box) {
            write_box(object);
        } else {
            write_quad(object);
        }
    }

    const Scene& scene_;
    const MitsubaSettings& settings_;
    std::string stem_;
    MitsubaScene made_;
    double reach_;  // largest coordinate difference between the eye and an object, in exported units
    XmlText xml_;
    std::map<std::string, std::string> image_files_;  // names of exported images by the path of the original image
    std::map<std::uint32_t, std::string> mesh_files_;
    std::map<Group, std::size_t> copies_;
};

}  // namespace

MitsubaScene mitsuba_scene(const Scene& scene, const MitsubaSettings& settings, const std::filesystem::path& out) {
    return Exporter(scene, settings, out).take();
}

Mesh indexed_mesh(const SceneMesh& mesh) {
    using Corner = std::array<float, 3>;
    // Adding +0 turns -0 into +0, so that equal vertex positions compare equal.
    const auto corner = [](const Vec3<float>& v) { return Corner{v.x + 0.0f, v.y + 0.0f, v.z + 0.0f}; };
    Mesh indexed;
    for (const Triangle<float>& t : mesh.triangles) {
        indexed.vertices.insert(indexed.vertices.end(), {corner(t.a), corner(t.b), corner(t.c)});
    }
    std::sort(indexed.vertices.begin(), indexed.vertices.end());
    indexed.vertices.erase(std::unique(indexed.vertices.begin(), indexed.vertices.end()), indexed.vertices.end());
    const auto index = [&](const Vec3<float>& v) {
        const auto found = std::lower_bound(indexed.vertices.begin(), indexed.vertices.end(), corner(v));
        return static_cast<std::uint32_t>(found - indexed.vertices.begin());
    };
    for (const Triangle<float>& t : mesh.triangles) {
        indexed.triangles.push_back({index(t.a), index(t.b), index(t.c)});
    }
    for (const CornerCoordinates& c : mesh.coordinates) {
        indexed.coordinates.push_back({{{c.u[0], c.v[0]}, {c.u[1], c.v[1]}, {c.u[2], c.v[2]}}});
    }
    return indexed;
}

}  // namespace pt
