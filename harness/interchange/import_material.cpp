// Imports a MATERIAL section of a CIS 565 scene; the rules are in harness/interchange/import_cis565.h.
#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/interchange/course_scene.h"
#include "harness/interchange/course_type.h"
#include "harness/scene/texture_image.h"

namespace pt {

namespace {

constexpr const char* black = "[0, 0, 0]";
constexpr double common_index = 1.5;  // index of refraction of common glass

class MaterialImporter {
public:
    MaterialImporter(CourseImport& import, std::size_t index);

    ScenePart part();

private:
    ScenePart emitter();
    ScenePart subsurface();
    ScenePart dielectric();
    ScenePart mirror();
    ScenePart mix();
    ScenePart diffuse();

    bool names_a_material() const;
    void apply_type();
    void apply_layers();
    bool refuse();
    ScenePart start(const std::string& type, const std::string& what);
    void add_colour(ScenePart& part, const std::string& member, const std::string& key) const;
    void add_surface_colour(ScenePart& part, const std::string& member, const std::string& key,
                            const std::vector<std::string>& replaced);
    void add_roughness(ScenePart& part);
    void find_image();

    const Cis565Line& line(const std::string& key) const { return *reader_.line(key); }
    bool has(const std::string& key) const { return reader_.line(key) != nullptr; }
    const Vec3d& colour(const std::string& key) const { return values_.at(key); }
    double number(const std::string& key) const { return values_.at(key).x; }
    bool is_set(const std::string& key) const { return values_.at(key) != Vec3d(0.0); }
    std::string specular_key() const { return is_set("SPECRGB") ? "SPECRGB" : "RGB"; }

    void warn(const std::string& key, const std::string& what);
    void warn_unused(const std::vector<std::string>& keys);
    void warn_unless_one(const std::string& key);
    void warn_unless_white(const std::string& key);
    void warn_of_rgb();
    void warn_of_no_specular(const std::string& asking_key);

    CourseImport* import_;
    const Cis565Section* section_;
    std::string label_;  // name of the material in messages, e.g. "material 2"
    Cis565SectionReader reader_;
    ImportFindings* warnings_;
    std::map<std::string, Vec3d> values_;  // values of the material's lines by key (single numbers in x); 0 if missing
    std::string what_;                     // description of the material in messages, e.g. "material 2 is a mirror"
    std::string image_;                    // texture as JSON for the scene file; empty: none
    CourseType type_ = CourseType::by_values;
    bool is_black_ = false;
};

MaterialImporter::MaterialImporter(CourseImport& import, std::size_t index)
    : import_(&import),
      section_(&import.sections->materials[index]),
      label_(section_->name.empty() ? "material " + section_->label : fmt::format("\"{}\"", section_->name)),
      reader_(*section_, import.result->problems),
      warnings_(&import.result->warnings) {
    if (names_a_material()) {
        warn("TYPE", "is the name of a material and no type: read as black, as the course's loader leaves it");
        type_ = CourseType::diffuse;
        is_black_ = true;
    } else if (has("TYPE")) {
        type_ = read_course_type(reader_, line("TYPE"));
    }
    if (has("TEXTURE") && !is_black_) {
        find_image();
    }
    const bool needs_colour = reader_.is_whole() && !has("TEXTURE");
    values_["RGB"] = has("TEXTURE") && !has("RGB") ? Vec3d(1.0)
                     : needs_colour                ? reader_.required_vector("RGB").value_or(Vec3d(0.0))
                                                   : reader_.vector("RGB");
    for (const char* key : {"SPECRGB", "SIGMAA", "SIGMAS"}) {
        values_[key] = reader_.vector(key);
    }
    for (const char* key : {"SPECEX", "REFL", "REFR", "REFRIOR"}) {
        values_[key] = {reader_.number(key), 0, 0};
    }
    for (const char* key : {"ROUGHNESS", "METALLIC"}) {
        const bool is_unset = has(key) && line(key).words.size() == 2 && line(key).words[1].starts_with("-1");
        values_[key] = {is_unset ? 0 : reader_.number(key), 0, 0};
    }
    const bool has_three = has("EMITTANCE") && line("EMITTANCE").words.size() == 4;
    values_["EMITTANCE"] = has_three ? reader_.vector("EMITTANCE") : Vec3d(reader_.number("EMITTANCE"));
    for (auto& [key, value] : values_) {
        value = is_black_ ? Vec3d(0.0) : value;
    }
}

// Whether TYPE is the name of another material, which happens only in JSON scenes, where materials have names.
bool MaterialImporter::names_a_material() const {
    return has("TYPE") && line("TYPE").words.size() == 2 && import_->sections->is_json &&
           !is_course_type(line("TYPE").words[1]) &&
           import_->sections->materials_by_word.contains(line("TYPE").words[1]);
}

void MaterialImporter::find_image() {
    const Cis565Line& named = line("TEXTURE");
    const std::string name = course_file_name(named);
    const auto found = import_->files.find(name);
    if (!found) {
        reader_.fail(named, "an image .png or .jpg that is there, beside this file or in a folder above it");
        return;
    }
    try {
        (void)read_texture_image(*found);
    } catch (const InputError& refusal) {
        reader_.fail(named, fmt::format("\"{}\", of which is said: {}", named.text(), refusal.what()),
                     "an image that can be read");
        return;
    }
    if (!found->string().ends_with(std::filesystem::path(name).lexically_normal().relative_path().string())) {
        import_->result->notes.add(named.number, fmt::format("{} is taken from {}", named.text(), found->string()));
    }
    warn("TEXTURE", "is read as sRGB with v upwards; formats of the course do not say");
    image_ = image_in_scene(name_beside(course_scene_file(*import_->source), *found));
}

void MaterialImporter::warn(const std::string& key, const std::string& what) {
    warnings_->add(line(key).number, fmt::format("{} {}", line(key).text(), what));
}

void MaterialImporter::warn_unused(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        if (is_set(key) && has(key)) {
            warn(key, "is not used: " + what_);
        }
    }
}

void MaterialImporter::warn_unless_one(const std::string& key) {
    if (is_set(key) && number(key) != 1) {
        warn(key, "is read as 1: only whether it is above 0 counts");
    }
}

// Warns of a material's colour that is not used, unless it is white and so has no effect.
void MaterialImporter::warn_unless_white(const std::string& key) {
    if (colour(key) != Vec3d(1.0)) {
        warn(key, "is not used: " + what_);
    }
}

void MaterialImporter::warn_of_rgb() {
    if (is_set("SPECRGB") && colour("SPECRGB") != colour("RGB")) {
        warn("RGB", fmt::format("is not used: {} of colour {}", what_, line("SPECRGB").text()));
    }
}

// Warns that RGB serves as a material's specular colour, except with a TYPE, for which the colour is always RGB.
void MaterialImporter::warn_of_no_specular(const std::string& asking_key) {
    if (is_set("SPECRGB") || !is_set("RGB") || !has("RGB") || type_ != CourseType::by_values) {
        return;
    }
    const bool has_line = has("SPECRGB");
    warn(has_line ? "SPECRGB" : asking_key,
         fmt::format("{}: {} of colour {}", has_line ? "is not used" : "has no SPECRGB", what_, line("RGB").text()));
}

ScenePart MaterialImporter::start(const std::string& type, const std::string& what) {
    what_ = fmt::format("{} is {}", label_, what);
    const std::string name = material_name(*section_);
    ScenePart part{.place = "$.materials." + name, .name = name, .head = &section_->head, .members = {}};
    part.add("type", json_of(type), nullptr);
    return part;
}

void MaterialImporter::add_colour(ScenePart& part, const std::string& member, const std::string& key) const {
    part.add(member, json_of(colour(key)), reader_.line(key), black);
}

// Adds the material's colour as the scene file's `member`: the texture, with warnings that it hides the colours of the
// lines `replaced`, or without a texture the colour of the line `key`.
void MaterialImporter::add_surface_colour(ScenePart& part, const std::string& member, const std::string& key,
                                          const std::vector<std::string>& replaced) {
    if (image_.empty()) {
        add_colour(part, member, key);
        return;
    }
    part.add(member, image_, &line("TEXTURE"), black);
    for (const std::string& other : replaced) {
        if (has(other) && is_set(other) && colour(other) != Vec3d(1.0)) {
            warn(other, fmt::format("is not used: {}, and shows {}", what_, course_file_name(line("TEXTURE"))));
        }
    }
}

// Adds the roughness, the square root of the GGX width alpha. The course's programs differ in what ROUGHNESS means.
void MaterialImporter::add_roughness(ScenePart& part) {
    part.add("roughness", json_of(number("ROUGHNESS")), reader_.line("ROUGHNESS"), "0");
    warn("ROUGHNESS", fmt::format("is read as GGX of the width {:.4g}, its square: programs differ",
                                  number("ROUGHNESS") * number("ROUGHNESS")));
}

ScenePart MaterialImporter::emitter() {
    const std::string strength = has("EMITTANCE") ? line("EMITTANCE").text() : "of its RGB";
    ScenePart part = start("emitter", fmt::format("an emitter ({})", strength));
    warn_unused({"SPECEX", "SPECRGB", "REFL", "REFR", "REFRIOR", "SIGMAA", "SIGMAS", "ROUGHNESS", "METALLIC"});
    const Vec3d& rgb = colour("RGB");
    const bool is_negative = rgb.x < 0 || rgb.y < 0 || rgb.z < 0;
    part.add("radiance", json_of(rgb * colour("EMITTANCE")),
             reader_.line(is_negative || !has("EMITTANCE") ? "RGB" : "EMITTANCE"), black);
    return part;
}

ScenePart MaterialImporter::subsurface() {
    ScenePart part = start("subsurface", "a subsurface body, of SIGMAA and SIGMAS alone");
    warn_unless_white("RGB");
    if (is_set("SPECRGB")) {
        warn_unless_white("SPECRGB");
    }
    warn_unused({"ROUGHNESS", "METALLIC"});
    warn_unless_one("REFR");
    if (is_set("REFR") && !is_set("REFRIOR")) {
        warn("REFR", fmt::format("without a REFRIOR above 0 is read as the index 1: {} is a subsurface body", label_));
    }
    if (!is_set("REFR") && is_set("REFRIOR") && number("REFRIOR") != 1) {
        warn("REFRIOR", fmt::format("is used although REFR is 0: {} is a subsurface body", label_));
    }
    if (is_set("REFRIOR")) {
        part.add("ior", json_of(number("REFRIOR")), &line("REFRIOR"), "1");
    }
    if (is_set("SIGMAA")) {
        add_colour(part, "sigma_a", "SIGMAA");
    }
    add_colour(part, "sigma_s", "SIGMAS");
    return part;
}

// Adds a dielectric's JSON members. REFL beside REFR is the course's glass, with Fresnel reflection as usual.
ScenePart MaterialImporter::dielectric() {
    const bool is_rough = is_set("ROUGHNESS");
    ScenePart part = start(is_rough ? "rough_dielectric" : "dielectric", "a dielectric");
    warn_unless_one("REFR");
    warn_unless_one("REFL");
    warn_unused({"SPECEX", "METALLIC"});
    warn_of_rgb();
    warn_of_no_specular("REFR");
    const bool has_index = has("REFRIOR"), is_typed = type_ != CourseType::by_values;
    if (!has_index && is_typed) {
        warnings_->add(section_->head.number, fmt::format("{} has no index of refraction: {} of index {}",
                                                          section_->head.text(), what_, common_index));
        part.add("ior", json_of(common_index), nullptr);
    } else {
        part.add("ior", json_of(number("REFRIOR")), reader_.line(has_index ? "REFRIOR" : "REFR"), "1");
    }
    if (is_rough) {
        add_roughness(part);
    }
    if (colour(specular_key()) != Vec3d(1.0)) {
        add_colour(part, "tint", specular_key());
    }
    if (is_set("SIGMAA")) {
        add_colour(part, "sigma_a", "SIGMAA");
    }
    return part;
}

ScenePart MaterialImporter::mirror() {
    const bool is_rough = is_set("ROUGHNESS");
    ScenePart part = start(is_rough ? "rough_conductor" : "mirror", is_rough ? "a rough conductor" : "a mirror");
    warn_unless_one("REFL");
    warn_unused({"SPECEX", "REFRIOR", "SIGMAA"});
    if (number("METALLIC") != 1) {
        warn_unused({"METALLIC"});
    }
    if (image_.empty()) {
        warn_of_rgb();
        warn_of_no_specular("REFL");
    }
    add_surface_colour(part, "reflectance", specular_key(), {"RGB", "SPECRGB"});
    if (is_rough) {
        add_roughness(part);
    }
    return part;
}

ScenePart MaterialImporter::mix() {
    ScenePart part = start("mix", "a mix of diffuse and a mirror");
    warn("SPECEX", "is read as a mix, a mirror with probability 0.5 and else diffuse; the exponent's size is lost");
    warn_unused({"REFRIOR", "SIGMAA", "ROUGHNESS", "METALLIC"});
    warn_of_no_specular("SPECEX");
    const bool has_colour_of_mirror = is_set("SPECRGB");
    add_surface_colour(part, "albedo", "RGB",
                       has_colour_of_mirror ? std::vector<std::string>{"RGB"} : std::vector<std::string>{});
    add_colour(part, "reflectance", specular_key());
    part.add("mirror_probability", "0.5", nullptr);
    return part;
}

ScenePart MaterialImporter::diffuse() {
    ScenePart part = start("diffuse", "diffuse");
    warn_unused({"SPECRGB", "REFRIOR", "SIGMAA", "METALLIC"});
    if (number("ROUGHNESS") != 1) {
        warn_unused({"ROUGHNESS"});
    }
    add_surface_colour(part, "albedo", "RGB", {"RGB"});
    return part;
}

// Sets REFL, REFR and EMITTANCE of a CIS 565 material as its TYPE implies.
void MaterialImporter::apply_type() {
    if (type_ == CourseType::emitter && !has("EMITTANCE")) {
        warnings_->add(section_->head.number, fmt::format("{} has no EMITTANCE: read as 1", section_->head.text()));
        values_["EMITTANCE"] = Vec3d(1.0);
    }
    if (type_ == CourseType::diffuse || type_ == CourseType::emitter) {
        what_ = label_ + (type_ == CourseType::diffuse ? " is diffuse" : " is an emitter");
        warn_unused({"REFL", "REFR"});
        values_["REFL"] = values_["REFR"] = Vec3d(0.0);
    }
    const bool is_glass = type_ == CourseType::glass || (type_ == CourseType::specular && is_set("REFR"));
    if (is_glass && !is_set("REFR")) {
        values_["REFR"] = {1, 0, 0};
    }
    if (type_ == CourseType::specular && !is_set("REFR") && !is_set("REFL")) {
        values_["REFL"] = {1, 0, 0};
    }
    const bool has_layers =
        type_ == CourseType::layered || (type_ == CourseType::by_values && !is_set("REFL") && !is_set("REFR") &&
                                         (is_set("METALLIC") || (has("METALLIC") && !section_->name.empty())));
    if (has_layers && !is_set("EMITTANCE")) {
        type_ = CourseType::layered;
        apply_layers();
    }
}

// Reduces a material of several layers to the largest of glass, metal and diffuse, which scene files cannot blend.
void MaterialImporter::apply_layers() {
    if (number("REFR") >= 0.5) {
        return;
    }
    if (is_set("REFR")) {
        warn("REFR", "is read as 0");
        values_["REFR"] = Vec3d(0.0);
    }
    if (number("METALLIC") >= 0.5) {
        if (number("METALLIC") < 1) {
            warn("METALLIC", "is read as 1: all metal");
        }
        values_["METALLIC"] = values_["REFL"] = {1, 0, 0};
        values_["REFRIOR"] = Vec3d(0.0);
        return;
    }
    if (is_set("METALLIC")) {
        warn("METALLIC", "is read as 0: no metal");
    }
    const std::string found = has("ROUGHNESS") ? line("ROUGHNESS").text() : section_->head.text();
    if (number("ROUGHNESS") != 1) {
        warnings_->add(has("ROUGHNESS") ? line("ROUGHNESS").number : section_->head.number,
                       fmt::format("{} is not used: {} is diffuse, and the gloss over it is lost", found, label_));
    }
    for (const char* key : {"METALLIC", "ROUGHNESS", "REFRIOR"}) {
        values_[key] = Vec3d(0.0);
    }
}

// Reports combinations of keywords that no material of a scene file can express; returns whether there is one.
bool MaterialImporter::refuse() {
    if (is_set("EMITTANCE")) {
        return false;
    }
    if (type_ == CourseType::subsurface && !is_set("SIGMAS")) {
        reader_.fail(line("TYPE"), "a subsurface body with SIGMA_S, in 1 / unit (what else scatters has no measure)");
    }
    if (is_set("SIGMAS") && (is_set("REFL") || is_set("SPECEX"))) {
        reader_.fail(line("SIGMAS"), fmt::format("SIGMAS together with {}", is_set("REFL") ? "REFL" : "SPECEX"),
                     "SIGMAS where REFL and SPECEX are 0 (a subsurface body reflects by its index alone)");
    }
    return !reader_.is_whole();
}

ScenePart MaterialImporter::part() {
    const auto broken = [&] {
        ScenePart part = start("diffuse", "");
        part.is_whole = false;
        return part;
    };
    if (!reader_.is_whole() || refuse()) {
        return broken();
    }
    apply_type();
    if (!image_.empty() && (is_set("EMITTANCE") || is_set("SIGMAS") || is_set("REFR"))) {
        reader_.fail(line("TEXTURE"), fmt::format("an image on a diffuse surface, a mirror, metal or a mix, which {} "
                                                  "is not",
                                                  label_));
        return broken();
    }
    return is_set("EMITTANCE") ? emitter()
           : is_set("SIGMAS")  ? subsurface()
           : is_set("REFR")    ? dielectric()
           : is_set("REFL")    ? mirror()
           : is_set("SPECEX")  ? mix()
                               : diffuse();
}

}  // namespace

ScenePart import_material(CourseImport& import, std::size_t index) { return MaterialImporter(import, index).part(); }

}  // namespace pt
