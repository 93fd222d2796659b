// What a MATERIAL section is read as: harness/scene/import_cis565.h says it in words.
#include <fmt/format.h>

#include "harness/scene/import_parts.h"

namespace pt {

namespace {

constexpr const char* black = "[0, 0, 0]";

class MaterialImporter {
public:
    MaterialImporter(const Cis565Section& section, std::size_t index, ImportFindings& problems,
                     ImportFindings& warnings);

    ScenePart part();

private:
    ScenePart emitter();
    ScenePart subsurface();
    ScenePart dielectric();
    ScenePart mirror();
    ScenePart mix();
    ScenePart diffuse();

    bool refuse();
    ScenePart start(const std::string& type, const std::string& what);
    void add_colour(ScenePart& part, const std::string& member, const std::string& key) const;

    const Cis565Line& line(const std::string& key) const { return *reader_.line(key); }
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

    const Cis565Section* section_;
    std::size_t index_;
    Cis565SectionReader reader_;
    ImportFindings* warnings_;
    std::map<std::string, Vec3d> values_;  // by key; a number is x; 0 where there is no such line
    std::string what_;                     // e.g. "material 2 is a mirror"
};

MaterialImporter::MaterialImporter(const Cis565Section& section, std::size_t index, ImportFindings& problems,
                                   ImportFindings& warnings)
    : section_(&section), index_(index), reader_(section, problems), warnings_(&warnings) {
    values_["RGB"] = reader_.required_vector("RGB").value_or(Vec3d(0.0));
    for (const char* key : {"SPECRGB", "SIGMAA", "SIGMAS"}) {
        values_[key] = reader_.vector(key);
    }
    for (const char* key : {"SPECEX", "REFL", "REFR", "REFRIOR", "EMITTANCE"}) {
        values_[key] = {reader_.number(key), 0, 0};
    }
}

void MaterialImporter::warn(const std::string& key, const std::string& what) {
    warnings_->add(line(key).number, fmt::format("{} {}", line(key).text(), what));
}

void MaterialImporter::warn_unused(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        if (is_set(key)) {
            warn(key, "is not used: " + what_);
        }
    }
}

void MaterialImporter::warn_unless_one(const std::string& key) {
    if (is_set(key) && number(key) != 1) {
        warn(key, "is read as 1: only whether it is above 0 counts");
    }
}

// For a colour that is not used: white would change nothing.
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

void MaterialImporter::warn_of_no_specular(const std::string& asking_key) {
    if (!is_set("SPECRGB") && is_set("RGB")) {
        const bool has_line = reader_.line("SPECRGB") != nullptr;
        warn(
            has_line ? "SPECRGB" : asking_key,
            fmt::format("{}: {} of colour {}", has_line ? "is not used" : "has no SPECRGB", what_, line("RGB").text()));
    }
}

ScenePart MaterialImporter::start(const std::string& type, const std::string& what) {
    what_ = fmt::format("material {} is {}", index_, what);
    ScenePart part{.place = "$.materials." + material_name(index_), .head = &section_->head, .members = {}};
    part.add("type", json_of(type), nullptr);
    return part;
}

void MaterialImporter::add_colour(ScenePart& part, const std::string& member, const std::string& key) const {
    part.add(member, json_of(colour(key)), &line(key), black);
}

ScenePart MaterialImporter::emitter() {
    ScenePart part = start("emitter", fmt::format("an emitter ({})", line("EMITTANCE").text()));
    warn_unused({"SPECEX", "SPECRGB", "REFL", "REFR", "REFRIOR", "SIGMAA", "SIGMAS"});
    const Vec3d& rgb = colour("RGB");
    const bool is_negative = rgb.x < 0 || rgb.y < 0 || rgb.z < 0;
    part.add("radiance", json_of(rgb * number("EMITTANCE")), &line(is_negative ? "RGB" : "EMITTANCE"), black);
    return part;
}

ScenePart MaterialImporter::subsurface() {
    ScenePart part = start("subsurface", "a subsurface body, of SIGMAA and SIGMAS alone");
    warn_unless_white("RGB");
    if (is_set("SPECRGB")) {
        warn_unless_white("SPECRGB");
    }
    warn_unless_one("REFR");
    if (is_set("REFR") && !is_set("REFRIOR")) {
        warn("REFR",
             fmt::format("without a REFRIOR above 0 is read as the index 1: material {} is a subsurface body", index_));
    }
    if (!is_set("REFR") && is_set("REFRIOR") && number("REFRIOR") != 1) {
        warn("REFRIOR", fmt::format("is used although REFR is 0: material {} is a subsurface body", index_));
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

ScenePart MaterialImporter::dielectric() {
    ScenePart part = start("dielectric", "a dielectric");
    warn_unless_one("REFR");
    warn_unused({"SPECEX"});
    warn_of_rgb();
    warn_of_no_specular("REFR");
    const bool has_index = reader_.line("REFRIOR") != nullptr;
    part.add("ior", json_of(number("REFRIOR")), &line(has_index ? "REFRIOR" : "REFR"), "1");
    if (colour(specular_key()) != Vec3d(1.0)) {
        add_colour(part, "tint", specular_key());
    }
    if (is_set("SIGMAA")) {
        add_colour(part, "sigma_a", "SIGMAA");
    }
    return part;
}

ScenePart MaterialImporter::mirror() {
    ScenePart part = start("mirror", "a mirror");
    warn_unless_one("REFL");
    warn_unused({"SPECEX", "REFRIOR", "SIGMAA"});
    warn_of_rgb();
    warn_of_no_specular("REFL");
    add_colour(part, "reflectance", specular_key());
    return part;
}

ScenePart MaterialImporter::mix() {
    ScenePart part = start("mix", "a mix of diffuse and a mirror");
    warn("SPECEX", "is read as a mix, a mirror with probability 0.5 and else diffuse; the exponent's size is lost");
    warn_unused({"REFRIOR", "SIGMAA"});
    warn_of_no_specular("SPECEX");
    add_colour(part, "albedo", "RGB");
    add_colour(part, "reflectance", specular_key());
    part.add("mirror_probability", "0.5", nullptr);
    return part;
}

ScenePart MaterialImporter::diffuse() {
    ScenePart part = start("diffuse", "diffuse");
    warn_unused({"SPECRGB", "REFRIOR", "SIGMAA"});
    add_colour(part, "albedo", "RGB");
    return part;
}

// Whether it is what no material of a scene file is.
bool MaterialImporter::refuse() {
    if (is_set("EMITTANCE")) {
        return false;
    }
    if (is_set("REFL") && is_set("REFR")) {
        reader_.fail(line("REFR"), fmt::format("REFL {} and REFR {} in one material", number("REFL"), number("REFR")),
                     "one of them above 0 (a dielectric reflects by itself, by Fresnel's equations)");
    }
    if (is_set("SIGMAS") && (is_set("REFL") || is_set("SPECEX"))) {
        reader_.fail(line("SIGMAS"), fmt::format("SIGMAS together with {}", is_set("REFL") ? "REFL" : "SPECEX"),
                     "SIGMAS where REFL and SPECEX are 0 (a subsurface body reflects by its index alone)");
    }
    return !reader_.is_whole();
}

ScenePart MaterialImporter::part() {
    if (!reader_.is_whole() || refuse()) {
        ScenePart part = start("diffuse", "");
        part.is_whole = false;
        return part;
    }
    return is_set("EMITTANCE") ? emitter()
           : is_set("SIGMAS")  ? subsurface()
           : is_set("REFR")    ? dielectric()
           : is_set("REFL")    ? mirror()
           : is_set("SPECEX")  ? mix()
                               : diffuse();
}

}  // namespace

ScenePart import_material(const Cis565Section& section, std::size_t index, ImportFindings& problems,
                          ImportFindings& warnings) {
    return MaterialImporter(section, index, problems, warnings).part();
}

}  // namespace pt
