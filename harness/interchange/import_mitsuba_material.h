// Converts the surface of a Mitsuba shape (BSDF, emitter and interior medium) to a material of a scene file.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "harness/interchange/mitsuba_object.h"

namespace pt {

struct MitsubaSurface {
    const XmlElement* bsdf = nullptr;      // BSDF; null: Mitsuba's default, diffuse 0.5 (black with an emitter)
    const XmlElement* emitter = nullptr;   // Mitsuba emitter of type area
    const XmlElement* interior = nullptr;  // Mitsuba medium inside the shape
    const XmlElement* shape = nullptr;
};

// Whether a material has a texture, and at which end of the image v is 0: at the bottom (v_up, as in scene files) or at
// the top (v_down, as in Mitsuba without to_uv).
enum class MitsubaImage { none, v_down, v_up };

class MitsubaMaterials {
public:
    explicit MitsubaMaterials(const MitsubaFile& file) : file_(&file) {}

    // Converts a Mitsuba surface and returns the material's number. Returns nothing, after reporting a problem, if
    // scene files cannot express it.
    std::optional<std::size_t> material_of(const MitsubaSurface& surface);
    // The material on the back of a one-sided emitter: the surface without its emitter if it is two-sided in Mitsuba,
    // otherwise black.
    std::optional<std::size_t> material_behind(const MitsubaSurface& surface);

    // The element that makes a material one-sided in Mitsuba; null if both programs reflect on both sides.
    const XmlElement* one_sided(std::size_t material) const { return one_sided_.at(material); }
    const XmlElement* emitter(std::size_t material) const { return emitters_.at(material); }
    MitsubaImage image(std::size_t material) const { return images_.at(material); }
    std::set<const XmlElement*> used() const;  // all Mitsuba BSDFs that shapes use

private:
    struct Bsdf {
        std::string type;  // kind of the material in the scene file
        std::vector<SceneMember> members;
        const XmlElement* one_sided = nullptr;
        bool is_good = true, is_black = false, is_glass = false;
        MitsubaImage image = MitsubaImage::none;
    };
    // A colour of a Mitsuba BSDF: constant or a texture.
    struct Colour {
        Vec3d value{0.0};
        std::string json;  // the colour or texture as JSON for the scene file
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
