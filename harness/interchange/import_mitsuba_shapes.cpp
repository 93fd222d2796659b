// Imports the shapes of Mitsuba 3 (src/shapes/), which differ from those of scene files in size and orientation.
#include "harness/interchange/import_mitsuba_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "harness/counted.h"
#include "harness/failure.h"
#include "harness/interchange/mitsuba_limits.h"
#include "harness/scene/scene_mesh.h"

namespace pt {

namespace {

// Name of Mitsuba's area emitter; the axis light_sampling has a choice of this name, which is not meant.
constexpr std::string_view mitsuba_area_emitter = "area";

// Limit on shapes, since nested instances of groups can multiply without end.
constexpr std::size_t most_shapes = 100000;

double length_of_vector(const Vec3d& v) { return std::sqrt(dot(v, v)); }

double largest_part_of(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Scales the affine map of a shape whose side is 2 in Mitsuba and 1 in scene files.
Affine of_twice_the_side(const Affine& map) {
    Affine own = map;
    for (Vec3d& column : own.column) {
        column = column * 2.0;
    }
    return own;
}

// The affine map of a scene file's quad, which lies in xz and faces +y, from the map of Mitsuba's rectangle, which lies
// in xy and faces +z. Where the map's third column points decides only which side is the front.
Affine quad_of(const Affine& map, bool is_flipped) {
    const Affine own = of_twice_the_side(map);
    const Vec3d normal = cross(own.column[0], own.column[1]);
    Vec3d front = own.column[2];
    const double across = length_of_vector(normal), along = dot(normal, front);
    if (across > 0 && !(std::abs(along) >= (1 - 1e-12) * across * length_of_vector(front) && along != 0)) {
        front = normal * (along < 0 ? -1 / across : 1 / across);
    }
    Affine quad;
    quad.column[0] = own.column[0];
    quad.column[1] = is_flipped ? -front : front;
    quad.column[2] = is_flipped ? own.column[1] : -own.column[1];
    quad.origin = own.origin;
    return quad;
}

// Coordinate at which two emitters back to back are joined: the middle, as `ptbench export` set them slightly apart.
double middle_of(double a, double b) {
    constexpr double last_bits = 2 * std::numeric_limits<double>::epsilon();
    return a == b ? a : shortest_within(0.5 * a + 0.5 * b, last_bits * std::max(std::abs(a), std::abs(b)));
}

}  // namespace

void MitsubaShapes::add(const XmlElement& shape) {
    if (shape.value_of("type") != "shapegroup") {  // Mitsuba's shapegroup is placed by its instances
        add_placed(shape, Affine(), 0);
    }
}

// Reads BSDF, emitter and medium of a Mitsuba shape; false if they cannot be imported.
bool MitsubaShapes::read_surface(MitsubaObject& object, MitsubaSurface& surface) {
    surface.shape = &object.element();
    const std::vector<const XmlElement*> bsdfs = object.objects("bsdf"), emitters = object.objects("emitter"),
                                         media = object.objects("medium");
    if (bsdfs.size() > 1 || emitters.size() > 1) {
        object.fail(object.element(), "one BSDF and one emitter");
        return false;
    }
    surface.bsdf = bsdfs.empty() ? nullptr : bsdfs.front();
    surface.emitter = emitters.empty() ? nullptr : emitters.front();
    if (surface.emitter != nullptr && surface.emitter->value_of("type") != mitsuba_area_emitter) {
        object.fail(*surface.emitter, "of a shape, an emitter of type area");
        return false;
    }
    for (const XmlElement& child : object.element().children) {
        const bool is_medium = child.tag == "medium" || (child.tag == "ref" && child.value_of("name") == "exterior");
        if (is_medium && child.value_of("name") != "interior") {
            object.fail(child, "a medium named interior");
            return false;
        }
    }
    surface.interior = media.empty() ? nullptr : media.front();
    object.ignore({"silhouette_sampling_weight"});
    return true;
}

bool MitsubaShapes::read_sphere(MitsubaObject& object, const Affine& outer, Placed& placed) {
    const Affine map = outer * object.transform("to_world");
    const Vec3d centre = object.point("center", Vec3d(0.0));
    const double diameter = 2 * object.number("radius", 1);
    const double lengths[3] = {length_of_vector(map.column[0]), length_of_vector(map.column[1]),
                               length_of_vector(map.column[2])};
    const auto [least, greatest] = std::minmax({lengths[0], lengths[1], lengths[2]});
    constexpr double slight = 1e-6;
    if (greatest - least > slight * greatest || shear_of(map) > slight || !(diameter > 0)) {
        object.fail(object.element(), "a sphere with a radius above 0 that is scaled alike along all axes");
        return false;
    }
    const double scale = shortest_within(lengths[0], 1e-15 * lengths[0]);
    placed.own = scaling(Vec3d(diameter * scale));
    placed.own.origin = map.point(centre);
    placed.map = map;
    return true;
}

bool MitsubaShapes::read_mesh_file(MitsubaObject& object, Placed& placed) {
    const std::string name = object.text("filename", "");
    const bool has_flat_normals = object.boolean("face_normals", false);
    placed.flips_v = object.boolean("flip_tex_coords", object.type() == "obj");
    if (name.empty()) {
        object.fail(object.element(), "a file name");
        return false;
    }
    placed.mesh = file_->draft->path_of(name);
    try {
        warn_of_mesh(file_->draft->result(), file_->place(object.element())->number, placed.mesh,
                     mesh_from_file(placed.mesh)->warnings);
    } catch (const InputError& error) {
        object.fail(*object.property("filename"), fmt::format("a mesh that can be read ({})", error.what()));
        return false;
    }
    if (!has_flat_normals) {
        file_->warn(object.element(), "has flat triangles here; without face_normals, Mitsuba bends their normals");
    }
    return true;
}

void MitsubaShapes::add_instance(MitsubaObject& object, const Affine& outer, int depth) {
    const Affine map = outer * object.transform("to_world");
    const std::vector<const XmlElement*> groups = object.objects("shape");
    if (groups.size() != 1 || groups.front()->value_of("type") != "shapegroup") {
        object.fail(object.element(), "a reference to one shapegroup");
    }
    object.finish("a shapegroup and to_world");
    if (!object.is_good()) {
        return;
    }
    for (const XmlElement& child : groups.front()->children) {
        if (visits_ > most_shapes) {
            return;
        }
        if (child.tag == "shape") {
            add_placed(child, map, depth + 1);
        } else {
            file_->refuse(child, "shapes in a shapegroup");
        }
    }
}

void MitsubaShapes::add_placed(const XmlElement& shape, const Affine& outer, int depth) {
    constexpr int deepest = 4;  // Mitsuba allows no instances within instances
    visits_ += 1;
    if (depth > deepest || visits_ > most_shapes) {
        if (depth > deepest || visits_ == most_shapes + 1) {  // the limit on the number of shapes is reported once
            file_->refuse(shape, "instances of shapes only, and at most 10^5 shapes");
        }
        return;
    }
    MitsubaObject object(shape, *file_);
    const std::string type = object.type();
    if (type == "instance") {
        add_instance(object, outer, depth);
        return;
    }
    const bool is_mesh = type == "obj" || type == "ply";
    if (!is_mesh && type != "sphere" && type != "cube" && type != "rectangle") {
        file_->refuse(shape, "a shape of type sphere, cube, rectangle, obj, ply, or instance of a shapegroup");
        return;
    }
    Placed placed;
    bool is_good = read_surface(object, placed.surface);
    placed.is_flipped = object.boolean("flip_normals", false);
    if (type == "sphere") {
        placed.kind = "sphere";
        is_good = read_sphere(object, outer, placed) && is_good;
    } else {
        const Affine map = outer * object.transform("to_world");
        placed.map = map;
        placed.kind = is_mesh ? "mesh" : type == "cube" ? "box" : "quad";
        placed.own = is_mesh ? map : type == "cube" ? of_twice_the_side(map) : quad_of(map, placed.is_flipped);
        is_good = (!is_mesh || read_mesh_file(object, placed)) && is_good;
    }
    object.finish("what a " + type + " has here");
    if (is_good && object.is_good()) {
        shapes_.push_back(placed);
    }
}

// Whether two emitting quads stand back to back. `far`: the length relative to which their gap must be small.
bool MitsubaShapes::are_back_to_back(const Placed& a, const Placed& b, double far) const {
    const auto is_lamp = [](const Placed& p) {
        return p.kind == "quad" && p.surface.emitter != nullptr && !p.is_pair && !p.is_gone;
    };
    if (!is_lamp(a) || !is_lamp(b) || a.surface.bsdf != b.surface.bsdf) {
        return false;
    }
    const auto near = [](const Vec3d& v, const Vec3d& w) {
        return largest_part_of(v - w) <= 1e-12 * largest_part_of(v);
    };
    const auto radiance = [&](const Placed& p) {
        for (const XmlElement& child : p.surface.emitter->children) {
            if (child.value_of("name") == "radiance") {
                return child.value_of("value");
            }
        }
        return std::string();
    };
    const Vec3d gap = a.own.origin - b.own.origin;
    const Vec3d normal = a.own.column[1] * (1 / length_of_vector(a.own.column[1]));
    const double along = dot(gap, normal);
    return radiance(a) == radiance(b) && near(a.own.column[0], b.own.column[0]) &&
           near(a.own.column[1], -b.own.column[1]) && near(a.own.column[2], -b.own.column[2]) && along >= 0 &&
           along <= std::ldexp(far, -12) &&
           length_of_vector(gap - normal * along) <= std::ldexp(along, -8) + 1e-14 * far;
}

// Joins pairs of one-sided emitters back to back, as `ptbench export` writes a two-sided emitter, into one emitter.
void MitsubaShapes::pair_lamps(const Vec3d& eye) {
    double far = 0;
    for (const Placed& shape : shapes_) {
        far = std::max({far, largest_part_of(shape.own.origin), largest_part_of(shape.own.origin - eye)});
    }
    for (std::size_t i = 0; i + 1 < shapes_.size(); ++i) {
        Placed &a = shapes_[i], &b = shapes_[i + 1];
        if (are_back_to_back(a, b, far)) {
            for (int axis = 0; axis < 3; ++axis) {
                a.own.origin[axis] = middle_of(a.own.origin[axis], b.own.origin[axis]);
            }
            a.is_pair = b.is_gone = true;
            file_->note(*b.surface.shape, fmt::format("is the back of the lamp in line {}: one quad, which shines to "
                                                      "both sides",
                                                      a.surface.shape->line));
        }
    }
}

// Adapts a textured shape so that each point has the texel that it has in Mitsuba (src/shapes/ of Mitsuba 3,
// kernels/texture.h).
bool MitsubaShapes::lay_image(Placed& placed, MitsubaImage image) {
    const XmlElement& shape = *placed.surface.shape;
    const bool is_up = image == MitsubaImage::v_up;
    if (placed.kind == "mesh") {
        return lay_image_on_mesh(placed, is_up == placed.flips_v);
    }
    if (placed.kind == "sphere" && !is_up && determinant(placed.map) > 0) {
        // A sphere's u and v are angles about z from x and from z in Mitsuba, about y from -z and from y in ptbench.
        const double size = length_of_vector(placed.own.column[0]) / length_of_vector(placed.map.column[0]);
        placed.own.column[0] = placed.map.column[1] * -size;
        placed.own.column[1] = placed.map.column[2] * size;
        placed.own.column[2] = placed.map.column[0] * -size;
        return true;
    }
    if (placed.kind == "quad" && placed.surface.emitter == nullptr) {
        placed.own = quad_of(placed.map, !is_up);
        return true;
    }
    file_->refuse(shape, placed.kind == "sphere" ? "a sphere that is not mirrored, with a texture without to_uv"
                         : placed.kind == "quad" ? "on a rectangle, an image or an emitter"
                                                 : "an image on a rectangle, a sphere or a mesh: on a cube it lies in "
                                                   "another way here");
    return false;
}

void MitsubaShapes::write(const Vec3d& eye) {
    pair_lamps(eye);
    for (Placed& shape : shapes_) {
        const std::optional<std::size_t> material =
            shape.is_gone ? std::nullopt : materials_.material_of(shape.surface);
        const MitsubaImage image = material ? materials_.image(*material) : MitsubaImage::none;
        if (!material || (image != MitsubaImage::none && !lay_image(shape, image))) {
            continue;
        }
        ImportDraft& draft = *file_->draft;
        const Cis565Line* at = file_->place(*shape.surface.shape);
        const std::size_t before = draft.parts.objects.size();
        const bool is_added = shape.kind == "mesh" ? draft.add_mesh(shape.mesh, shape.own, *material, at)
                                                   : draft.add_shape(shape.kind, shape.own, *material, at);
        shape.object = is_added ? before : no_object;
        shape.material = *material;
    }
}

// Adds the back of each one-sided emitter: a quad of equal size so close behind it that the gap is not seen.
void MitsubaShapes::write_behind(const Scene& scene) {
    double farthest = 0;
    for (const SceneObject& object : scene.objects) {
        const Extent extent = extent_of(scene, object);
        farthest =
            std::max({farthest, largest_part_of(extent.low), largest_part_of(extent.high),
                      largest_part_of(extent.low - scene.camera.eye), largest_part_of(extent.high - scene.camera.eye)});
    }
    const double gap = std::ldexp(farthest, -16);
    for (const Placed& shape : std::vector<Placed>(shapes_)) {
        if (shape.kind != "quad" || shape.surface.emitter == nullptr || shape.is_pair || shape.object == no_object) {
            continue;
        }
        const std::optional<std::size_t> material = materials_.material_behind(shape.surface);
        if (!material) {
            continue;
        }
        Affine behind = shape.own;
        const Vec3d& front = shape.own.column[1];
        behind.origin = behind.origin - front * (gap / length_of_vector(front));
        if (file_->draft->add_shape("quad", behind, *material, file_->place(*shape.surface.shape))) {
            file_->note(*shape.surface.shape, fmt::format("shines to one side: a quad stands {:.3g} behind it", gap));
        }
    }
}

// Divides radiances of emitters inside glass by n^2, by which Mitsuba's radiances are larger (docs/other_renderers.md).
void MitsubaShapes::dim_lamps_in_glass(const Scene& scene) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(), is_glass)) {
        return;
    }
    std::map<std::pair<std::size_t, double>, std::size_t> dimmed;
    ImportDraft& draft = *file_->draft;
    for (const Placed& shape : shapes_) {
        if (shape.object == no_object || shape.surface.emitter == nullptr) {
            continue;
        }
        const SceneObject& lamp = scene.objects[shape.object];
        const double factor = radiance_factor(scene, lamp);
        if (factor == 1) {
            continue;
        }
        const auto [known, is_new] = dimmed.try_emplace({shape.material, factor});
        if (is_new) {
            ScenePart part = draft.parts.materials[shape.material];
            Vec3d radiance = scene.materials[lamp.material].emission * (1 / factor);
            for (int i = 0; i < 3; ++i) {
                radiance[i] = shortest_within(radiance[i], 1e-15 * radiance[i]);
            }
            for (SceneMember& member : part.members) {
                member.value = member.key == "radiance" || member.key == "emission" ? json_of(radiance) : member.value;
            }
            known->second = draft.add_material(std::move(part), draft.material_name_of(shape.material) + "_in_glass");
            file_->note(*shape.surface.emitter, fmt::format("is inside glass: its radiance is divided by n^2 = {:.6g}, "
                                                            "which Mitsuba does on the way out",
                                                            factor));
        }
        for (SceneMember& member : draft.parts.objects[shape.object].members) {
            member.value = member.key == "material" ? json_of(draft.material_name_of(known->second)) : member.value;
        }
    }
}

// Warns of shapes that reflect or emit on one side in Mitsuba but on both in ptbench.
void MitsubaShapes::warn_of_sides(const Scene& scene) {
    std::map<const XmlElement*, std::size_t> one_sided;
    for (const Placed& shape : shapes_) {
        if (shape.object == no_object) {
            continue;
        }
        const SceneObject& object = scene.objects[shape.object];
        const bool is_mesh = object.mesh != SceneObject::no_mesh;
        const bool is_open = is_mesh ? !scene.meshes[object.mesh]->is_closed : shape.kind == "quad";
        const bool shows_inside = !is_open && contains_point(scene, object, scene.camera.eye);
        const bool is_turned = shape.is_flipped != shows_inside;
        const XmlElement* side = materials_.one_sided(shape.material);
        if (side != nullptr && (is_open || is_turned) && !(shape.kind == "quad" && shape.surface.emitter != nullptr)) {
            one_sided[side] += 1;
        }
        if (shape.surface.emitter != nullptr && !is_open && is_turned) {
            file_->warn(*shape.surface.shape,
                        fmt::format("shines to both sides here, there only {}, and the eye is {}",
                                    shape.is_flipped ? "inwards" : "outwards", shows_inside ? "inside" : "outside"));
        }
    }
    for (const auto& [element, count] : one_sided) {
        file_->warn(*element, fmt::format("reflects on both sides here, there on the front only, and {} can be seen "
                                          "from behind (twosided is the same in both)",
                                          counted(count, "shape")));
    }
}

void MitsubaShapes::warn_of_differences(const Scene& scene) {
    const std::string start = "scene: ", before_found = ": found ", before_allowed = ", allowed: ";
    for (const std::string& message : mitsuba_problems(scene, "scene", scene.max_depth)) {
        const std::size_t found = message.find(before_found), allowed = message.rfind(before_allowed);
        const std::string place = message.substr(start.size(), found - start.size());
        if (!place.starts_with("$.objects[") || allowed == std::string::npos) {
            continue;  // faults of materials and the camera were reported at their import
        }
        const std::size_t object = std::stoul(place.substr(std::string("$.objects[").size()));
        const Cis565Line& head = *file_->draft->parts.objects[object].head;
        const std::size_t at = found + before_found.size();
        file_->draft->warnings().add(head.number, fmt::format("{} is {}; the picture is Mitsuba's with {}", head.text(),
                                                              message.substr(at, allowed - at),
                                                              message.substr(allowed + before_allowed.size())));
    }
}

void MitsubaShapes::write_whole(const Scene& scene) {
    warn_of_sides(scene);
    warn_of_differences(scene);
    dim_lamps_in_glass(scene);
    write_behind(scene);
}

}  // namespace pt
