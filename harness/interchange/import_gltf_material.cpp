// Imports glTF 2.0 materials (3.9, appendix B), KHR_materials_emissive_strength, _ior, _specular, _transmission,
// _volume.
#ifdef PTBENCH_HAS_TINYGLTF

#include "harness/interchange/import_gltf_material.h"

#include <algorithm>
#include <cmath>

namespace pt {

namespace {

using GltfObject = tinygltf::Value::Object;

constexpr const char* emissive_strength = "KHR_materials_emissive_strength";
constexpr const char* index_of_refraction = "KHR_materials_ior";
constexpr const char* specular = "KHR_materials_specular";
constexpr const char* transmission = "KHR_materials_transmission";
constexpr const char* volume = "KHR_materials_volume";
constexpr const char* no_other_texture = "no texture: of a material baseColorTexture and normalTexture are read";

bool is_white_colour(const Vec3d& v) { return v.x == 1 && v.y == 1 && v.z == 1; }

}  // namespace

// Reads one glTF material.
struct GltfMaterials::Reader {
    const tinygltf::Material* material;
    ImportDraft* draft;
    std::string pointer;  // JSON pointer to the glTF material, such as "/materials/3"
    bool is_good = true;
    GltfImage image = {};      // base colour texture of the material; empty: none
    std::string normals = {};  // JSON text of the normal map; empty: none

    const Cis565Line* place(const std::string& key, const std::string& value) const {
        return draft->place(0, pointer + key + ": " + value);
    }
    void fail(const std::string& key, const std::string& value, const std::string& allowed) {
        draft->refuse(*place(key, value), allowed);
        is_good = false;
    }
    void warn(const std::string& key, const std::string& what) const {
        draft->warnings().add(0, pointer + key + " " + what);
    }

    const tinygltf::Value* value_in(const char* extension, const char* key) const {
        const auto found = material->extensions.find(extension);
        return found != material->extensions.end() && found->second.IsObject() && found->second.Has(key)
                   ? &found->second.Get(key)
                   : nullptr;
    }
    std::string key_of(const char* extension, const char* key) const {
        return std::string("/extensions/") + extension + "/" + key;
    }
    double number_in(const char* extension, const char* key, double otherwise) {
        const tinygltf::Value* value = value_in(extension, key);
        if (value != nullptr && !value->IsNumber()) {
            fail(key_of(extension, key), "no number", "a number");
            return otherwise;
        }
        return value == nullptr ? otherwise : value->GetNumberAsDouble();
    }
    Vec3d colour_in(const char* extension, const char* key, const Vec3d& otherwise) {
        const tinygltf::Value* value = value_in(extension, key);
        if (value == nullptr) {
            return otherwise;
        }
        Vec3d colour(0.0);
        bool is_colour = value->IsArray() && value->ArrayLen() == 3;
        for (int i = 0; i < 3 && is_colour; ++i) {
            is_colour = value->Get(i).IsNumber();
            colour[i] = is_colour ? value->Get(i).GetNumberAsDouble() : 0;
        }
        if (!is_colour) {
            fail(key_of(extension, key), "no colour", "3 numbers");
        }
        return colour;
    }

    void read_image(GltfImages& images, const Vec3d& colour, bool is_glass);
    void read_normals(GltfImages& images);
    void add_normals(ScenePart& part) const;
    void refuse_textures();
    void refuse_extensions();
    void refuse_see_through();
    void add_glass(ScenePart& part, const Vec3d& colour, double roughness);
    void warn_of_thin_walls() const;
    double coat_index();
    void add_principled(ScenePart& part, double metallic, double roughness, double through);
    void add_surface(ScenePart& part, const Vec3d& colour, double metallic, double roughness, const Vec3d& emission);
};

void GltfMaterials::Reader::read_image(GltfImages& images, const Vec3d& colour, bool is_glass) {
    const tinygltf::TextureInfo& texture = material->pbrMetallicRoughness.baseColorTexture;
    const std::string key = "/pbrMetallicRoughness/baseColorTexture", value = fmt::format("texture {}", texture.index);
    if (texture.index < 0) {
        return;
    }
    if (is_glass) {
        fail(key, value, "no texture on glass");
    } else if (texture.texCoord != 0) {
        fail(key + "/texCoord", fmt::format("{}", texture.texCoord), "0, for TEXCOORD_0");
    } else if (!texture.extensions.empty()) {
        fail(key, value, "a texture without " + texture.extensions.begin()->first);
    } else if (!is_white_colour(colour)) {
        fail("/pbrMetallicRoughness/baseColorFactor", json_of(colour),
             "[1, 1, 1] with baseColorTexture: scene files do not multiply images");
    } else {
        image = images.of_texture(texture.index);
        if (image.value.empty()) {
            fail(key, value, image.refusal);
        }
    }
}

void GltfMaterials::Reader::read_normals(GltfImages& images) {
    const tinygltf::NormalTextureInfo& texture = material->normalTexture;
    const std::string value = fmt::format("texture {}", texture.index);
    if (texture.index < 0) {
        return;
    }
    if (texture.texCoord != 0) {
        fail("/normalTexture/texCoord", fmt::format("{}", texture.texCoord), "0, for TEXCOORD_0");
    } else if (!texture.extensions.empty()) {
        fail("/normalTexture", value, "a texture without " + texture.extensions.begin()->first);
    } else {
        const GltfImage found = images.of_texture(texture.index);
        if (found.value.empty()) {
            fail("/normalTexture", value, found.refusal);
            return;
        }
        normals = texture.scale == 1
                      ? found.value
                      : found.value.substr(0, found.value.size() - 1) + ", \"scale\": " + json_of(texture.scale) + "}";
    }
}

void GltfMaterials::Reader::add_normals(ScenePart& part) const {
    if (!normals.empty()) {
        part.add("normal", normals, place("/normalTexture", normals));
    }
}

void GltfMaterials::Reader::refuse_textures() {
    const auto refuse = [&](int index, const char* key) {
        if (index >= 0) {
            fail(key, fmt::format("texture {}", index), no_other_texture);
        }
    };
    refuse(material->pbrMetallicRoughness.metallicRoughnessTexture.index,
           "/pbrMetallicRoughness/metallicRoughnessTexture");
    refuse(material->emissiveTexture.index, "/emissiveTexture");
    if (material->occlusionTexture.index >= 0) {
        draft->notes().add(0, pointer + "/occlusionTexture is left out: what it stands for is computed");
    }
}

void GltfMaterials::Reader::refuse_extensions() {
    for (const auto& [name, value] : material->extensions) {
        const bool is_known = name == emissive_strength || name == index_of_refraction || name == specular ||
                              name == transmission || name == volume;
        if (!is_known || !value.IsObject()) {
            fail("/extensions/" + name, "an extension",
                 "KHR_materials_emissive_strength, _ior, _specular, _transmission or _volume");
            continue;
        }
        for (const std::string& key : value.Keys()) {
            if (key.ends_with("Texture")) {
                fail("/extensions/" + name + "/" + key, "a texture", no_other_texture);
            }
        }
    }
}

void GltfMaterials::Reader::refuse_see_through() {
    const auto& colour = material->pbrMetallicRoughness.baseColorFactor;
    const double alpha = colour.size() == 4 ? colour[3] : 1;
    const bool is_opaque = material->alphaMode.empty() || material->alphaMode == "OPAQUE" ||
                           (material->alphaMode == "BLEND" && alpha == 1) ||
                           (material->alphaMode == "MASK" && alpha >= material->alphaCutoff);
    if (is_opaque && image.has_alpha && !material->alphaMode.empty() && material->alphaMode != "OPAQUE") {
        fail("/alphaMode", material->alphaMode + " with an image that has an alpha channel",
             "OPAQUE, or no such channel");
    }
    if (!is_opaque) {
        fail("/alphaMode", material->alphaMode + fmt::format(" with alpha {}", alpha), "OPAQUE, or alpha 1");
    }
}

void GltfMaterials::Reader::warn_of_thin_walls() const {
    warn(std::string("/extensions/") + transmission,
         "is of a thin wall there (KHR_materials_volume gives no thickness); here the mesh is solid glass");
}

// Adds the JSON members of a glass material: a surface that reflects or transmits all light.
void GltfMaterials::Reader::add_glass(ScenePart& part, const Vec3d& colour, double roughness) {
    const double index = number_in(index_of_refraction, "ior", 1.5);
    if (number_in(specular, "specularFactor", 1) != 1 ||
        !is_white_colour(colour_in(specular, "specularColorFactor", Vec3d(1.0)))) {
        fail(std::string("/extensions/") + specular, "specular of glass", "specularFactor and specularColorFactor 1");
    }
    part.add("type", roughness > 0 ? "\"rough_dielectric\"" : "\"dielectric\"", nullptr);
    part.add("ior", json_of(index), place(key_of(index_of_refraction, "ior"), json_of(index)), "1");
    if (!is_white_colour(colour)) {
        part.add("tint", json_of(colour), place("/pbrMetallicRoughness/baseColorFactor", json_of(colour)), "[0, 0, 0]");
    }
    if (roughness > 0) {
        part.add("roughness", json_of(roughness), place("/pbrMetallicRoughness/roughnessFactor", json_of(roughness)),
                 "1");
    }
    add_normals(part);
    if (!(number_in(volume, "thicknessFactor", 0) > 0)) {
        warn_of_thin_walls();
        return;
    }
    const tinygltf::Value* distance = value_in(volume, "attenuationDistance");
    if (distance == nullptr) {
        return;
    }
    const double length = number_in(volume, "attenuationDistance", 1);
    const Vec3d kept = colour_in(volume, "attenuationColor", Vec3d(1.0));
    // glTF's attenuationColor is the transmittance over the attenuationDistance, which gives sigma_a.
    Vec3d sigma(0.0);
    for (int i = 0; i < 3; ++i) {
        sigma[i] = -std::log(kept[i]) / length;
    }
    if (!(length > 0) || !(std::min({kept.x, kept.y, kept.z}) > 0)) {
        fail(std::string("/extensions/") + volume, "light that is absorbed at once",
             "an attenuationDistance above 0 and an attenuationColor above 0");
        return;
    }
    if (!is_black(sigma)) {
        part.add("sigma_a", json_of(sigma), place(key_of(volume, "attenuationColor"), json_of(kept)), "[0, 0, 0]");
    }
}

// Index of refraction of a dielectric's coat; 1 if it reflects nothing. KHR_materials_specular scales the reflectance:
// the index returned has the scaled reflectance at normal incidence.
double GltfMaterials::Reader::coat_index() {
    const double index = number_in(index_of_refraction, "ior", 1.5);
    const double factor = number_in(specular, "specularFactor", 1);
    const Vec3d tint = colour_in(specular, "specularColorFactor", Vec3d(1.0));
    const bool is_in_range = index >= 1 && index <= 1e4;
    if (factor == 0) {
        return 1;
    }
    if (!is_in_range) {
        fail(key_of(index_of_refraction, "ior"), json_of(index), "from 1 to 1e4 where nothing passes through");
        return 1.5;
    }
    if (factor == 1 && is_white_colour(tint)) {
        return index;
    }
    const double root = (index - 1) / (index + 1);
    const double reflected = factor * std::max({tint.x, tint.y, tint.z}) * root * root;
    if (!(factor > 0 && factor <= 1 && reflected >= 0 && reflected < 0.99)) {
        fail(std::string("/extensions/") + specular, fmt::format("a coat that reflects {:.3g}", reflected),
             "specularFactor from 0 to 1, and from 0 to 0.99 of the light at normal incidence");
        return 1.5;
    }
    const double same = (1 + std::sqrt(reflected)) / (1 - std::sqrt(reflected));
    warn(std::string("/extensions/") + specular,
         fmt::format("is read as index {:.4g}, which reflects {:.3g} at normal incidence, and white at grazing angles",
                     same, reflected));
    return same;
}

// Adds the JSON members of a principled material, except base colour and emission.
void GltfMaterials::Reader::add_principled(ScenePart& part, double metallic, double roughness, double through) {
    const double index = coat_index();
    part.add("metallic", json_of(metallic), place("/pbrMetallicRoughness/metallicFactor", json_of(metallic)), "0");
    part.add("roughness", json_of(roughness), place("/pbrMetallicRoughness/roughnessFactor", json_of(roughness)), "1");
    if (through != 0) {
        part.add("transmission", json_of(through), place(key_of(transmission, "transmissionFactor"), json_of(through)),
                 "0");
    }
    part.add("ior", json_of(index), place(key_of(index_of_refraction, "ior"), json_of(index)), "1.5");
    warn("",
         "is read as principled: as glTF has it, but with Fresnel's formula for Schlick's, and beneath its coat "
         "1 - max(F(n.v), F(n.l)) of a diffuse surface, not 1 - F(v.h), which gains light at grazing angles");
    if (through == 0) {
        return;
    }
    if (!(number_in(volume, "thicknessFactor", 0) > 0)) {
        warn_of_thin_walls();
    } else if (value_in(volume, "attenuationDistance") != nullptr) {
        fail(std::string("/extensions/") + volume, "light that is absorbed",
             "none, or transmissionFactor 1 and metallicFactor 0");
    }
}

void GltfMaterials::Reader::add_surface(ScenePart& part, const Vec3d& colour, double metallic, double roughness,
                                        const Vec3d& emission) {
    const bool is_image = !image.value.empty();
    const std::string shown = is_image ? image.value : json_of(colour);
    const Cis565Line* of_colour =
        place(is_image ? "/pbrMetallicRoughness/baseColorTexture" : "/pbrMetallicRoughness/baseColorFactor", shown);
    const Cis565Line* of_emission = place("/emissiveFactor", json_of(emission));
    const double through = metallic == 1 ? 0 : number_in(transmission, "transmissionFactor", 0);
    const double index = number_in(index_of_refraction, "ior", 1.5), ratio = (index - 1) / (index + 1);
    const double coat = number_in(specular, "specularFactor", 1) * ratio * ratio;
    if (metallic == 1) {
        part.add("type", "\"rough_conductor\"", nullptr);
        part.add("reflectance", shown, of_colour, "[0, 0, 0]");
        part.add("roughness", json_of(roughness), place("/pbrMetallicRoughness/roughnessFactor", json_of(roughness)),
                 "1");
    } else if (metallic == 0 && through == 0 && is_black(colour) && !is_image && !is_black(emission)) {
        if (coat != 0) {
            warn("", fmt::format(
                         "is read as an emitter: its clear coat, which reflects {:.3g} at normal incidence and more "
                         "at grazing angles, is left out (specularFactor 0 has none)",
                         coat));
        }
        part.add("type", "\"emitter\"", nullptr);
        part.add("radiance", json_of(emission), of_emission, "[0, 0, 0]");
        return;
    } else if (metallic == 0 && through == 0 && coat == 0) {
        part.add("type", "\"diffuse\"", nullptr);
        part.add("albedo", shown, of_colour, "[0, 0, 0]");
    } else {
        part.add("type", "\"principled\"", nullptr);
        part.add("base_colour", shown, of_colour, "[0, 0, 0]");
        add_principled(part, metallic, roughness, through);
    }
    add_normals(part);
    if (!is_black(emission)) {
        part.add("emission", json_of(emission), of_emission, "[0, 0, 0]");
    }
}

std::optional<std::size_t> GltfMaterials::read(int index) {
    static const tinygltf::Material glTFs_own;
    if (index >= static_cast<int>(model_->materials.size())) {
        draft_->problems().add(0, fmt::format("/materials: found number {}, allowed: 0 to {}", index,
                                              static_cast<int>(model_->materials.size()) - 1));
        return std::nullopt;
    }
    const tinygltf::Material& material = index < 0 ? glTFs_own : model_->materials[static_cast<std::size_t>(index)];
    Reader reader{&material, draft_, index < 0 ? "/materials" : fmt::format("/materials/{}", index)};
    const auto& base = material.pbrMetallicRoughness.baseColorFactor;
    const Vec3d colour = base.size() >= 3 ? Vec3d(base[0], base[1], base[2]) : Vec3d(1.0);
    const double roughness = material.pbrMetallicRoughness.roughnessFactor;
    const double metallic = material.pbrMetallicRoughness.metallicFactor;
    const double through = reader.number_in(transmission, "transmissionFactor", 0);
    reader.read_image(images_, colour, through == 1 && metallic == 0);
    reader.read_normals(images_);
    reader.refuse_textures();
    reader.refuse_extensions();
    reader.refuse_see_through();
    const auto& factor = material.emissiveFactor;
    const Vec3d emission = (factor.size() == 3 ? Vec3d(factor[0], factor[1], factor[2]) : Vec3d(0.0)) *
                           reader.number_in(emissive_strength, "emissiveStrength", 1);
    ScenePart part{.place = "", .head = draft_->place(0, reader.pointer), .members = {}};
    if (through != 0 && metallic != 1 && !is_black(emission)) {
        reader.fail(reader.key_of(transmission, "transmissionFactor"), json_of(through), "0 with emission");
    } else if (through == 1 && metallic == 0) {
        reader.add_glass(part, colour, roughness);
    } else {
        reader.add_surface(part, colour, metallic, roughness, emission);
    }
    if (!reader.is_good) {
        return std::nullopt;
    }
    return draft_->add_material(std::move(part), index < 0 ? "default" : material.name);
}

std::optional<std::size_t> GltfMaterials::material_of(int index) {
    const auto known = known_.find(index);
    return known != known_.end() ? known->second : known_.emplace(index, read(index)).first->second;
}

}  // namespace pt

#endif
