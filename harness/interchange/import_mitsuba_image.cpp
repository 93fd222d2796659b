// Imports the textures of a Mitsuba scene, <texture type="bitmap">, and adapts the meshes that show them.
#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/interchange/import_mitsuba_shapes.h"
#include "harness/mesh/read_mesh.h"
#include "harness/scene/scene_mesh.h"
#include "harness/scene/texture_image.h"

namespace pt {

// Reads a bitmap texture. In Mitsuba an image's first row is at v = 0 (src/textures/bitmap.cpp).
MitsubaMaterials::Colour MitsubaMaterials::read_bitmap(const XmlElement& element, MitsubaObject& object) {
    MitsubaObject bitmap(element, *file_);
    if (bitmap.type() != "bitmap") {
        object.fail(element, "a texture of type bitmap");
        return {};
    }
    const std::string name = bitmap.text("filename", "");
    if (bitmap.text("filter_type", "bilinear") != "bilinear") {
        bitmap.fail(*bitmap.property("filter_type"), "bilinear: texels are blended here");
    }
    if (bitmap.text("wrap_mode", "repeat") != "repeat") {
        bitmap.fail(*bitmap.property("wrap_mode"), "repeat: images repeat here");
    }
    if (bitmap.boolean("raw", false)) {
        bitmap.fail(*bitmap.property("raw"), "false: the values of an image are sRGB here");
    }
    const Affine map = bitmap.transform("to_uv");
    const auto is = [](const Vec3d& v, double x, double y) { return v.x == x && v.y == y; };
    const bool keeps_u = is(map.column[0], 1, 0) && map.origin.x == 0;
    const bool is_plain = keeps_u && is(map.column[1], 0, 1) && map.origin.y == 0;
    const bool is_turned = keeps_u && is(map.column[1], 0, -1) && (map.origin.y == 0 || map.origin.y == 1);
    if (!is_plain && !is_turned) {
        bitmap.fail(*bitmap.property("to_uv"), "none, or a scale by 1 and -1");
    }
    bitmap.ignore({"format", "accel"});
    bitmap.finish("filename, filter_type, wrap_mode, raw, to_uv, format and accel");
    const std::string file = file_->draft->path_of(name);
    try {
        (void)read_texture_image(file);
    } catch (const InputError& error) {
        const XmlElement* named = bitmap.property("filename");
        bitmap.fail(named != nullptr ? *named : element, fmt::format("an image that can be read ({})", error.what()));
    }
    if (!bitmap.is_good()) {
        object.spoil();
        return {};
    }
    return {.value = Vec3d(1.0),
            .json = image_in_scene(file_->draft->name_in_scene(file)),
            .image = is_turned ? MitsubaImage::v_up : MitsubaImage::v_down};
}

MitsubaMaterials::Colour MitsubaMaterials::read_colour(MitsubaObject& object, const std::string& name,
                                                       const Vec3d& otherwise) {
    const XmlElement* found = object.property(name);
    if (found != nullptr && found->tag == "ref") {
        const auto known = file_->by_id.find(found->value_of("id"));
        found = known == file_->by_id.end() ? nullptr : known->second;
    }
    if (found != nullptr && found->tag == "texture") {
        return read_bitmap(*found, object);
    }
    const Vec3d colour = object.colour(name, otherwise);
    return {.value = colour, .json = json_of(colour)};
}

bool MitsubaShapes::lay_image_on_mesh(Placed& placed, bool turns_v) {
    const XmlElement& shape = *placed.surface.shape;
    if (mesh_from_file(placed.mesh)->coordinates.empty()) {
        file_->refuse(shape, "a mesh with texture coordinates, since its BSDF has an image");
        return false;
    }
    if (!turns_v) {
        return true;
    }
    const auto [known, is_new] = turned_.try_emplace(placed.mesh);
    if (is_new) {
        Mesh mesh = read_mesh(placed.mesh);
        for (auto& corners : mesh.coordinates) {
            for (std::array<float, 2>& corner : corners) {
                corner[1] = 1 - corner[1];
            }
        }
        known->second = file_->draft->keep_mesh(mesh);
        file_->note(shape, fmt::format("has v downwards: its mesh, with v turned round, is written as {}",
                                       file_->draft->name_in_scene(known->second)));
    }
    placed.mesh = known->second;
    return true;
}

}  // namespace pt
