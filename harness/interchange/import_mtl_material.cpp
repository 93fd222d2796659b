#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/failure.h"
#include "harness/interchange/import_mtl.h"
#include "harness/mesh/text_numbers.h"
#include "harness/scene/texture_image.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

constexpr const char* black_colour = "[0, 0, 0]";
constexpr double index_of_glass = 1.5;
constexpr int highest_illumination = 9;

double brightest_of(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

class MtlImporter {
public:
    MtlImporter(CourseImport& import, const MtlMaterial& material, const fs::path& library, const Cis565Line& at)
        : import_(&import), material_(&material), library_(library), at_(&at) {}

    ScenePart part();

private:
    bool has(const std::string& key) const { return material_->lines.contains(key); }
    const MtlLine& line(const std::string& key) const { return material_->lines.at(key); }
    std::string text_of(const std::string& words, std::size_t number) const {
        return fmt::format("{} line {}: {}", library_.filename().string(), number, words);
    }
    const Cis565Line* place(const std::string& key);
    void fail(const std::string& key, const std::string& allowed);
    void warn(const std::string& key, const std::string& what);
    void warn_if_coloured(const std::string& key, const std::string& what);

    void check_keys();
    std::vector<double> numbers(const std::string& key, std::size_t most);
    Vec3d colour(const std::string& key, double otherwise);
    double number(const std::string& key, double otherwise);
    int illumination();
    bool is_seen_through();
    std::optional<fs::path> image_called(std::string name);
    void find_image();

    void make_emitter(ScenePart& part, const Vec3d& radiance);
    void make_glass(ScenePart& part);
    void make_surface(ScenePart& part);
    void make_shiny(ScenePart& part);
    void make_diffuse(ScenePart& part);

    CourseImport* import_;
    const MtlMaterial* material_;
    fs::path library_;
    const Cis565Line* at_;
    bool is_whole_ = true;
    int illumination_ = 1;
    std::string image_;
};

const Cis565Line* MtlImporter::place(const std::string& key) {
    import_->places.push_back({.number = at_->number, .words = {text_of(line(key).text(), line(key).number)}});
    return &import_->places.back();
}

void MtlImporter::fail(const std::string& key, const std::string& allowed) {
    import_->result->problems.add(at_->number, fmt::format("found \"{}\", allowed: {}", place(key)->text(), allowed));
    is_whole_ = false;
}

void MtlImporter::warn(const std::string& key, const std::string& what) {
    import_->result->warnings.add(at_->number, fmt::format("{} {}", place(key)->text(), what));
}

void MtlImporter::warn_if_coloured(const std::string& key, const std::string& what) {
    if (has(key) && colour(key, 0) != Vec3d(0.0)) {
        warn(key, what);
    }
}

void MtlImporter::check_keys() {
    static const std::set<std::string> read{"ka", "kd", "ks",    "ke",     "ns",        "ni",     "tf",
                                            "d",  "tr", "illum", "map_kd", "sharpness", "map_ka", "map_aat"};
    static const std::set<std::string> lost{"map_ks", "map_ns", "pr",     "pm",     "ps",     "pc",
                                            "pcr",    "aniso",  "anisor", "map_pr", "map_pm", "map_ps"};
    static const std::set<std::string> other{"map_bump", "bump",  "norm",   "map_norm", "disp", "map_disp",
                                             "decal",    "map_d", "map_tr", "map_ke",   "refl"};
    for (const MtlLine& twice : material_->overruled) {
        import_->result->warnings.add(at_->number, fmt::format("{} is not used: a later line says it again",
                                                               text_of(twice.text(), twice.number)));
    }
    for (const auto& [key, words] : material_->lines) {
        const bool is_off = std::all_of(words.words.begin() + 1, words.words.end(), [](const std::string& word) {
            double value = 1;
            return parse_real(std::string_view(word), value) && value == 0;
        });
        if (read.contains(key) || is_off) {
            continue;
        }
        if (lost.contains(key)) {
            warn(key, "is lost: scene files have nothing like it");
        } else if (other.contains(key)) {
            fail(key, "no image here (map_Kd is read; no normal, bump, opacity or emission map is)");
        } else {
            fail(key, "Ka, Kd, Ks, Ke, Ns, Ni, Tf, d, Tr, illum or map_Kd");
        }
    }
}

std::vector<double> MtlImporter::numbers(const std::string& key, std::size_t most) {
    std::vector<double> values;
    for (std::size_t i = 1; i < line(key).words.size(); ++i) {
        double value = 0;
        if (!parse_real(std::string_view(line(key).words[i]), value) || !std::isfinite(value)) {
            values.clear();
            break;
        }
        values.push_back(value);
    }
    if (values.size() != 1 && values.size() != most) {
        const std::string three = most == 1 ? "" : fmt::format(" or {}", most);
        fail(key, fmt::format("1{} finite number{}", three, most == 1 ? "" : "s"));
        values.assign(1, 0);
    }
    return values;
}

// Reads a colour of an MTL material; a single number means grey.
Vec3d MtlImporter::colour(const std::string& key, double otherwise) {
    if (!has(key)) {
        return Vec3d(otherwise);
    }
    const std::vector<double> values = numbers(key, 3);
    return values.size() == 1 ? Vec3d(values[0]) : Vec3d(values[0], values[1], values[2]);
}

double MtlImporter::number(const std::string& key, double otherwise) {
    return has(key) ? numbers(key, 1)[0] : otherwise;
}

int MtlImporter::illumination() {
    const double value = number("illum", 1);
    if (value != std::floor(value) || value < 0 || value > highest_illumination) {
        fail("illum", fmt::format("a whole number from 0 to {}", highest_illumination));
        return 1;
    }
    if (value == 0) {
        warn("illum", "is read as illum 1: without shading it would be no surface");
    }
    return static_cast<int>(value);
}

// Whether an MTL material is transparent, by d or else by Tr, whose sense differs between programs that write both.
bool MtlImporter::is_seen_through() {
    const std::string key = has("d") ? "d" : "tr";
    const double opacity = has("d") ? number("d", 1) : 1 - number("tr", 0);
    if (opacity != 1) {
        fail(key, "1, or Tr 0 (of what light goes through, scene files have glass: illum 4, 6, 7 or 9)");
    }
    return opacity != 1;
}

std::optional<fs::path> MtlImporter::image_called(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    std::error_code error;
    const fs::path beside = library_.parent_path() / name;
    return fs::is_regular_file(beside, error) ? std::optional(beside) : import_->files.find(name);
}

void MtlImporter::find_image() {
    const std::vector<std::string>& words = line("map_kd").words;
    if (words.size() < 2 || words[1].starts_with('-')) {
        fail("map_kd", "map_Kd and an image (options of maps are not read)");
        return;
    }
    const std::string name = fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " "));
    const auto whole = image_called(name), found = whole ? whole : image_called(without_comment(name));
    if (!found) {
        fail("map_kd", "an image .png or .jpg that is there, beside the library or in a folder above the scene");
        return;
    }
    try {
        (void)read_texture_image(*found);
    } catch (const InputError& refusal) {
        fail("map_kd", fmt::format("an image that can be read; of this one is said: {}", refusal.what()));
        return;
    }
    warn("map_kd", "is read as sRGB with v upwards; the format does not say");
    if (has("kd") && colour("kd", 0) != Vec3d(1.0)) {
        warn("kd", "is not used: the image of map_Kd stands for it");
    }
    image_ = image_in_scene(name_beside(course_scene_file(*import_->source), *found));
}

void MtlImporter::make_emitter(ScenePart& part, const Vec3d& radiance) {
    part.add("type", json_of(std::string("emitter")), nullptr);
    part.add("radiance", json_of(radiance), place("ke"), black_colour);
    warn_if_coloured("kd", "is not used: it is an emitter, by Ke");
}

void MtlImporter::make_glass(ScenePart& part) {
    part.add("type", json_of(std::string("dielectric")), nullptr);
    if (!has("ni")) {
        warn("illum", fmt::format("is glass without an Ni: of index {}", index_of_glass));
    }
    part.add("ior", json_of(number("ni", index_of_glass)), place(has("ni") ? "ni" : "illum"), "1");
    if (const Vec3d tint = colour("tf", 1); tint != Vec3d(1.0)) {
        part.add("tint", json_of(tint), place("tf"), black_colour);
    }
    warn_if_coloured("kd", fmt::format("is not used: it is glass, by illum {}", illumination_));
}

// Makes a mix of diffuse Kd and mirror Ks: probabilities in proportion to brightness, by which the colours are divided.
void MtlImporter::make_shiny(ScenePart& part) {
    const Vec3d albedo = colour("kd", 0), reflectance = colour("ks", 0);
    const double of_mirror = brightest_of(reflectance), sum = brightest_of(albedo) + of_mirror;
    if (illumination_ == 5) {
        warn("illum", "has a mirror by Fresnel's share: read as one that reflects Ks from everywhere");
    }
    if (!(brightest_of(albedo) > 0)) {
        part.add("type", json_of(std::string("mirror")), nullptr);
        part.add("reflectance", json_of(reflectance), place("ks"), black_colour);
        return;
    }
    const double probability = of_mirror / sum, scale = std::max(sum, 1.0);
    if (sum > 1) {
        warn("ks", fmt::format("and Kd reflect more than comes, {:.4g}: both are divided by that", sum));
    }
    part.add("type", json_of(std::string("mix")), nullptr);
    part.add("albedo", json_of(albedo / ((1 - probability) * scale)), place("kd"), black_colour);
    part.add("reflectance", json_of(reflectance / (probability * scale)), place("ks"), black_colour);
    part.add("mirror_probability", json_of(probability), place("ks"), "0.5");
}

void MtlImporter::make_diffuse(ScenePart& part) {
    part.add("type", json_of(std::string("diffuse")), nullptr);
    if (!image_.empty()) {
        part.add("albedo", image_, place("map_kd"), black_colour);
    } else if (has("kd")) {
        part.add("albedo", json_of(colour("kd", 0)), place("kd"), black_colour);
    } else {
        import_->result->problems.add(at_->number, fmt::format("found \"{}\" without Kd, allowed: with it",
                                                               text_of("newmtl " + material_->name, material_->line)));
        is_whole_ = false;
    }
    warn_if_coloured("ks", "is lost: highlights of lamps alone are no reflection");
}

// Makes a material that neither emits nor transmits light.
void MtlImporter::make_surface(ScenePart& part) {
    if (has("map_kd")) {
        find_image();
    }
    const bool is_shiny = illumination_ == 3 || illumination_ == 5 || illumination_ == 8;
    if (is_whole_ && is_shiny && image_.empty() && colour("ks", 0) != Vec3d(0.0)) {
        make_shiny(part);
    } else if (is_whole_) {
        make_diffuse(part);
    }
}

ScenePart MtlImporter::part() {
    ScenePart part{.place = "", .name = "", .head = at_, .members = {}};
    check_keys();
    illumination_ = illumination();
    const bool is_glass = illumination_ == 4 || illumination_ == 6 || illumination_ == 7 || illumination_ == 9;
    const Vec3d radiance = colour("ke", 0);
    const bool is_opaque = is_glass || !is_seen_through();
    if (is_opaque && is_whole_) {
        if (radiance != Vec3d(0.0)) {
            make_emitter(part, radiance);
        } else if (is_glass) {
            make_glass(part);
        } else {
            make_surface(part);
        }
    }
    part.is_whole = is_whole_;
    return part;
}

}  // namespace

ScenePart import_mtl_material(CourseImport& import, const MtlMaterial& material, const fs::path& library,
                              const Cis565Line& at) {
    return MtlImporter(import, material, library, at).part();
}

}  // namespace pt
