// What a shape of a Mitsuba file looks like, as a material of a scene file: BSDF, emission and the medium inside.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "harness/interchange/mitsuba_object.h"

namespace pt {

struct MitsubaSurface {
    const XmlElement* bsdf = nullptr;      // null: Mitsuba's own, diffuse 0.5, or black under an emitter
    const XmlElement* emitter = nullptr;   // of type area
    const XmlElement* interior = nullptr;  // medium
    const XmlElement* shape = nullptr;
};

// Which way up a material's image is: with v, which is 0 at the bottom here, or as Mitsuba has it without to_uv,
// against it.
enum class MitsubaImage { none, v_down, v_up };

class MitsubaMaterials {
public:
    explicit MitsubaMaterials(const MitsubaFile& file) : file_(&file) {}

    // The material's number; nothing, and a problem, where there is no such material.
    std::optional<std::size_t> material_of(const MitsubaSurface& surface);
    // What stands behind a lamp that shines to one side: the surface without its emitter, black where it has one side
    // only.
    std::optional<std::size_t> material_behind(const MitsubaSurface& surface);

    // The element that has one side in Mitsuba; null where both sides of the material reflect here and there.
    const XmlElement* one_sided(std::size_t material) const { return one_sided_.at(material); }
    const XmlElement* emitter(std::size_t material) const { return emitters_.at(material); }
    MitsubaImage image(std::size_t material) const { return images_.at(material); }
    std::set<const XmlElement*> used() const;  // BSDFs

private:
    struct Bsdf {
        std::string type;  // of the scene file
        std::vector<SceneMember> members;
        const XmlElement* one_sided = nullptr;
        bool is_good = true, is_black = false, is_glass = false;
        MitsubaImage image = MitsubaImage::none;
    };
    // A colour of a material: one colour, or an image.
    struct Colour {
        Vec3d value{0.0};
        std::string json;  // as scene files have it
        MitsubaImage image = MitsubaImage::none;
    };
    using Key = std::tuple<const XmlElement*, const XmlElement*, const XmlElement*, bool>;

    Colour read_colour(MitsubaObject& object, const std::string& name, const Vec3d& otherwise);
    Colour read_bitmap(const XmlElement& element, MitsubaObject& object);
    const Bsdf& bsdf_of(const XmlElement* element);
    Bsdf read_bsdf(const XmlElement& element, int depth);
    Bsdf read_diffuse(MitsubaObject& object);
    Bsdf read_conductor(MitsubaObject& object, bool is_rough);
    Bsdf read_dielectric(MitsubaObject& object, bool is_rough);
    Bsdf read_blend(MitsubaObject& object, int depth);
    std::optional<double> read_index(MitsubaObject& object, const std::string& name, const std::string& otherwise);
    double read_roughness(MitsubaObject& object, std::string& changes);
    bool add_medium(const XmlElement& element, const MitsubaSurface& surface, const Bsdf& bsdf, ScenePart& part);
    bool add_emission(const MitsubaSurface& surface, const Bsdf& bsdf, ScenePart& part);
    std::optional<std::size_t> make(const MitsubaSurface& surface, const Bsdf& bsdf, const Key& key);

    const MitsubaFile* file_;
    std::map<const XmlElement*, Bsdf> bsdfs_;
    std::map<Key, std::optional<std::size_t>> made_;
    std::map<std::size_t, const XmlElement*> one_sided_, emitters_;
    std::map<std::size_t, MitsubaImage> images_;
};

}  // namespace pt
