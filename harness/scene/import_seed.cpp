#include "harness/scene/import_seed.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "harness/error.h"

namespace pt {

namespace {

struct Line {
    std::size_t number = 0;  // from 1
    std::vector<std::string> words;
};

// A MATERIAL, CAMERA or OBJECT line and the lines up to the next one, by their first word.
struct Section {
    Line head;
    std::map<std::string, Line> lines;
};

struct SeedFile {
    std::vector<Section> materials, objects;
    std::optional<Section> camera;
};

class SeedReader {
public:
    SeedReader(const std::string& text, const std::string& file) : file_(file) { read_sections(text); }

    std::string to_json() const;

private:
    [[noreturn]] void fail(const Line& line, const std::string& found, const std::string& allowed) const {
        throw InputError(fmt::format("{}:{}: found {}, allowed: {}", file_, line.number, found, allowed));
    }
    [[noreturn]] void fail(const Line& line, const std::string& allowed) const {
        fail(line, fmt::format("\"{}\"", fmt::join(line.words, " ")), allowed);
    }

    void read_sections(const std::string& text);
    Section* start_section(const Line& line);
    void start_numbered(const Line& line, std::vector<Section>& sections) const;
    void add_line(Section& section, const Line& line) const;

    const Line& required(const Section& section, const std::string& key) const;
    double parse_number(const Line& line, const std::string& word, const std::string& allowed) const;
    double parse_whole(const Line& line, std::size_t index, const std::string& allowed) const;
    double number(const Section& section, const std::string& key) const;
    double number(const Line& line) const;
    Vec3d vector(const Section& section, const std::string& key) const;
    Vec3d vector(const Line& line) const;

    std::string camera_json(const Section& camera) const;
    std::string material_json(const Section& material) const;
    std::string object_json(const Section& object) const;
    bool anything_moves() const;
    void check(const std::string& json) const;

    std::string file_;
    SeedFile seed_;
};

const std::vector<std::string>& keys_of(const std::string& section) {
    static const std::map<std::string, std::vector<std::string>> keys{
        {"MATERIAL", {"RGB", "SPECEX", "SPECRGB", "REFL", "REFR", "REFRIOR", "EMITTANCE", "SIGMAA", "SIGMAS"}},
        {"CAMERA", {"RES", "FOVY", "ITERATIONS", "DEPTH", "FILE", "EYE", "LOOKAT", "VIEW", "UP"}},
        {"OBJECT", {"cube", "sphere", "material", "TRANS", "ROTAT", "SCALE", "VEL"}},
    };
    return keys.at(section);
}

bool is_black(const Vec3d& v) { return v == Vec3d(0.0); }

// Adding 0 turns -0 into 0.
std::string json_of(double value) { return fmt::format("{}", value + 0.0); }

std::string json_of(const Vec3d& v) { return fmt::format("[{}, {}, {}]", json_of(v.x), json_of(v.y), json_of(v.z)); }

std::string json_of(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void SeedReader::read_sections(const std::string& text) {
    std::istringstream stream(text);
    std::string content;
    Section* section = nullptr;
    for (std::size_t number = 1; std::getline(stream, content); ++number) {
        Line line{number, {}};
        std::istringstream words(content);  // white space includes the \r of files from Windows
        for (std::string word; words >> word;) {
            line.words.push_back(word);
        }
        if (line.words.empty() || line.words[0].starts_with("//")) {
            continue;
        }
        if (Section* started = start_section(line)) {
            section = started;
        } else if (section != nullptr) {
            add_line(*section, line);
        } else {
            fail(line, "MATERIAL n, CAMERA or OBJECT n");
        }
    }
    if (!seed_.camera) {
        throw InputError(fmt::format("{}: found no CAMERA, allowed: one", file_));
    }
}

// Null if the line starts none.
Section* SeedReader::start_section(const Line& line) {
    const std::string& word = line.words[0];
    if (word == "CAMERA") {
        if (seed_.camera) {
            fail(line, fmt::format("one CAMERA; the first is in line {}", seed_.camera->head.number));
        }
        if (line.words.size() != 1) {
            fail(line, "CAMERA alone on its line");
        }
        return &seed_.camera.emplace(Section{line, {}});
    }
    if (word == "MATERIAL") {
        start_numbered(line, seed_.materials);
        return &seed_.materials.back();
    }
    if (word == "OBJECT") {
        start_numbered(line, seed_.objects);
        return &seed_.objects.back();
    }
    return nullptr;
}

void SeedReader::start_numbered(const Line& line, std::vector<Section>& sections) const {
    const std::string expected = std::to_string(sections.size());
    if (line.words.size() != 2 || line.words[1] != expected) {
        fail(line, fmt::format("{} {} (they count up from 0)", line.words[0], expected));
    }
    sections.push_back({line, {}});
}

void SeedReader::add_line(Section& section, const Line& line) const {
    const std::string& key = line.words[0];
    const std::string& kind = section.head.words[0];
    const std::vector<std::string>& keys = keys_of(kind);
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
        fail(line, fmt::format("in {}: {}", kind, fmt::join(keys, ", ")));
    }
    const auto only_once = [&](const std::string& other) {
        if (const auto found = section.lines.find(other); found != section.lines.end()) {
            fail(line, fmt::format("{} once; line {} has {}", key == other ? key : key + " or " + other,
                                   found->second.number, other));
        }
    };
    only_once(key);
    if (key == "LOOKAT" || key == "VIEW") {
        only_once(key == "VIEW" ? "LOOKAT" : "VIEW");
    }
    if (key == "cube" || key == "sphere") {
        only_once(key == "cube" ? "sphere" : "cube");
        if (line.words.size() != 1) {
            fail(line, key + " alone on its line");
        }
    }
    section.lines.emplace(key, line);
}

const Line& SeedReader::required(const Section& section, const std::string& key) const {
    const auto found = section.lines.find(key);
    if (found == section.lines.end()) {
        fail(section.head, fmt::format("{} without {}", fmt::join(section.head.words, " "), key), "with it");
    }
    return found->second;
}

double SeedReader::parse_number(const Line& line, const std::string& word, const std::string& allowed) const {
    double value = 0;
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* end = word.data() + word.size();
    const auto [stopped, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stopped != end || !std::isfinite(value)) {
        fail(line, allowed);
    }
    return value;
}

double SeedReader::parse_whole(const Line& line, std::size_t index, const std::string& allowed) const {
    const double value = parse_number(line, line.words[index], allowed);
    if (value != std::floor(value) || value < 0 || value > 1e9) {
        fail(line, allowed);
    }
    return value;
}

double SeedReader::number(const Line& line) const {
    const std::string allowed = line.words[0] + " and 1 finite number";
    if (line.words.size() != 2) {
        fail(line, allowed);
    }
    return parse_number(line, line.words[1], allowed);
}

// No less than 0; 0 where there is no such line.
double SeedReader::number(const Section& section, const std::string& key) const {
    const auto found = section.lines.find(key);
    if (found == section.lines.end()) {
        return 0;
    }
    const double value = number(found->second);
    if (value < 0) {
        fail(found->second, key + " of 0 or more");
    }
    return value;
}

Vec3d SeedReader::vector(const Line& line) const {
    const std::string allowed = line.words[0] + " and 3 finite numbers";
    if (line.words.size() != 4) {
        fail(line, allowed);
    }
    return {parse_number(line, line.words[1], allowed), parse_number(line, line.words[2], allowed),
            parse_number(line, line.words[3], allowed)};
}

// 0 where there is no such line.
Vec3d SeedReader::vector(const Section& section, const std::string& key) const {
    const auto found = section.lines.find(key);
    return found == section.lines.end() ? Vec3d(0.0) : vector(found->second);
}

std::string SeedReader::material_json(const Section& material) const {
    const Vec3d rgb = vector(required(material, "RGB"));
    const Vec3d specular_rgb = vector(material, "SPECRGB");
    const Vec3d specular = is_black(specular_rgb) ? rgb : specular_rgb;
    const double exponent = number(material, "SPECEX");
    const double reflective = number(material, "REFL");
    const double refractive = number(material, "REFR");
    const double ior = number(material, "REFRIOR");
    const double emittance = number(material, "EMITTANCE");
    const Vec3d sigma_a = vector(material, "SIGMAA");
    const Vec3d sigma_s = vector(material, "SIGMAS");
    const std::string absorption = is_black(sigma_a) ? "" : fmt::format(", \"sigma_a\": {}", json_of(sigma_a));
    if (emittance > 0) {
        return fmt::format("{{\"type\": \"emitter\", \"radiance\": {}}}", json_of(rgb * emittance));
    }
    if (reflective > 0 && refractive > 0) {
        fail(material.lines.at("REFR"), fmt::format("REFL {} and REFR {} in one material", reflective, refractive),
             "one of them above 0 (a dielectric reflects by itself, by Fresnel's equations)");
    }
    if (!is_black(sigma_s)) {
        if (reflective > 0 || exponent > 0) {
            fail(material.lines.at("SIGMAS"),
                 fmt::format("SIGMAS together with {}", reflective > 0 ? "REFL" : "SPECEX"),
                 "SIGMAS where REFL and SPECEX are 0 (a subsurface body reflects by its index alone)");
        }
        return fmt::format("{{\"type\": \"subsurface\"{}{}, \"sigma_s\": {}}}",
                           ior > 0 ? fmt::format(", \"ior\": {}", json_of(ior)) : "", absorption, json_of(sigma_s));
    }
    if (refractive > 0) {
        const std::string tint = specular == Vec3d(1.0) ? "" : fmt::format(", \"tint\": {}", json_of(specular));
        return fmt::format("{{\"type\": \"dielectric\", \"ior\": {}{}{}}}", json_of(ior), tint, absorption);
    }
    if (reflective > 0) {
        return fmt::format("{{\"type\": \"mirror\", \"reflectance\": {}}}", json_of(specular));
    }
    if (exponent > 0) {
        return fmt::format("{{\"type\": \"mix\", \"albedo\": {}, \"reflectance\": {}, \"mirror_probability\": 0.5}}",
                           json_of(rgb), json_of(specular));
    }
    return fmt::format("{{\"type\": \"diffuse\", \"albedo\": {}}}", json_of(rgb));
}

std::string SeedReader::object_json(const Section& object) const {
    if (!object.lines.contains("cube") && !object.lines.contains("sphere")) {
        fail(object.head, fmt::format("{} without a shape", fmt::join(object.head.words, " ")), "with cube or sphere");
    }
    const Line& material = required(object, "material");
    const std::string materials =
        seed_.materials.empty() ? "no material is there" : fmt::format("material 0 to {}", seed_.materials.size() - 1);
    if (material.words.size() != 2) {
        fail(material, materials);
    }
    const double index = parse_whole(material, 1, materials);
    if (index >= static_cast<double>(seed_.materials.size())) {
        fail(material, materials);
    }
    std::string json = fmt::format("{{\"shape\": \"{}\", \"material\": \"material_{}\"",
                                   object.lines.contains("cube") ? "box" : "sphere", json_of(index));
    const auto add = [&](const std::string& key, const Vec3d& value, double neutral) {
        if (value != Vec3d(neutral)) {
            const bool uniform = key == "scale" && value.x == value.y && value.y == value.z;
            json += fmt::format(", \"{}\": {}", key, uniform ? json_of(value.x) : json_of(value));
        }
    };
    add("translate", vector(required(object, "TRANS")), 0);
    add("rotate_degrees", rotation_x_first(vector(required(object, "ROTAT"))), 0);
    add("scale", vector(required(object, "SCALE")), 1);
    add("velocity", vector(object, "VEL"), 0);
    return json + "}";
}

bool SeedReader::anything_moves() const {
    return std::any_of(seed_.objects.begin(), seed_.objects.end(),
                       [this](const Section& object) { return !is_black(vector(object, "VEL")); });
}

std::string SeedReader::camera_json(const Section& camera) const {
    const Line& resolution = required(camera, "RES");
    const std::string allowed = "RES and 2 whole numbers, width and height";
    if (resolution.words.size() != 3) {
        fail(resolution, allowed);
    }
    const double width = parse_whole(resolution, 1, allowed);
    const double height = parse_whole(resolution, 2, allowed);
    const Vec3d eye = vector(required(camera, "EYE"));
    const Vec3d look_at =
        camera.lines.contains("VIEW") ? eye + vector(required(camera, "VIEW")) : vector(required(camera, "LOOKAT"));
    std::string json = fmt::format("{{\"eye\": {}, \"look_at\": {}, \"up\": {}, \"vertical_fov_degrees\": {}, ",
                                   json_of(eye), json_of(look_at), json_of(vector(required(camera, "UP"))),
                                   json_of(2 * number(required(camera, "FOVY"))));
    json += fmt::format("\"resolution\": [{}, {}]", json_of(width), json_of(height));
    if (anything_moves()) {
        json += ",\n    \"shutter\": {\"open\": 0, \"close\": 1, \"density\": \"late\"}";
    }
    return json + "}";
}

std::string SeedReader::to_json() const {
    const Section& camera = *seed_.camera;
    if (camera.lines.contains("ITERATIONS")) {
        number(camera, "ITERATIONS");  // of no use here, but it must be a number
    }
    const Line& name = required(camera, "FILE");
    if (name.words.size() != 2) {
        fail(name, "FILE and a name: 1 to 64 letters, digits, '_' and '-'");
    }
    const Line& depth = required(camera, "DEPTH");
    if (depth.words.size() != 2) {
        fail(depth, "DEPTH and 1 whole number");
    }
    std::vector<std::string> materials;
    for (std::size_t i = 0; i < seed_.materials.size(); ++i) {
        materials.push_back(fmt::format("    \"material_{}\": {}", i, material_json(seed_.materials[i])));
    }
    std::vector<std::string> objects;
    for (const Section& object : seed_.objects) {
        objects.push_back("    " + object_json(object));
    }
    const std::string description = "Imported from " + std::filesystem::path(file_).filename().string() + ".";
    std::string json =
        fmt::format("{{\n  \"name\": {},\n  \"description\": {},\n  \"max_depth\": {},\n  \"camera\": {},\n",
                    json_of(name.words[1]), json_of(description),
                    json_of(parse_whole(depth, 1, "DEPTH and 1 whole number")), camera_json(camera));
    json += fmt::format("  \"materials\": {{\n{}\n  }},\n  \"objects\": [\n{}\n  ]\n}}\n", fmt::join(materials, ",\n"),
                        fmt::join(objects, ",\n"));
    check(json);
    return json;
}

// Whether scene files allow the values. Their reader names a place in the JSON, which the user never wrote: the line of
// the section that the place comes from goes before it.
void SeedReader::check(const std::string& json) const {
    try {
        parse_scene(json, file_);
    } catch (const InputError& error) {
        const std::string message = std::string(error.what()).substr(file_.size() + 2);  // without "FILE: "
        Line line = seed_.camera->head;
        const auto blame = [&](const Line& candidate, const std::string& place) {
            const bool is_within =
                message.starts_with(place) && message.find_first_of(".:[", place.size()) == place.size();
            line = is_within ? candidate : line;
        };
        blame(seed_.camera->lines.at("FILE"), "$.name");
        blame(seed_.camera->lines.at("DEPTH"), "$.max_depth");
        for (std::size_t i = 0; i < seed_.materials.size(); ++i) {
            blame(seed_.materials[i].head, fmt::format("$.materials.material_{}", i));
        }
        for (std::size_t i = 0; i < seed_.objects.size(); ++i) {
            blame(seed_.objects[i].head, fmt::format("$.objects[{}]", i));
        }
        throw InputError(fmt::format("{}:{}: as a scene, {}", file_, line.number, message));
    }
}

}  // namespace

std::string import_seed_scene(const std::string& text, const std::string& file) {
    return SeedReader(text, file).to_json();
}

Vec3d rotation_x_first(const Vec3d& degrees) {
    const int turned = (degrees.x != 0 ? 1 : 0) + (degrees.y != 0 ? 1 : 0) + (degrees.z != 0 ? 1 : 0);
    if (turned <= 1) {
        return degrees;
    }
    // Rx(a) Ry(b) Rz(c) is the transpose of Rz(-c) Ry(-b) Rx(-a), so the columns of that are its rows.
    const Rotation transpose = rotation_of(-degrees);
    const auto matrix = [&](int row, int column) { return transpose.column[row][column]; };
    const double cosine_y = std::hypot(matrix(0, 0), matrix(1, 0));
    // Where cosine_y is 0, x and z turn about the same axis, and z may as well be 0.
    const double cosine_z = cosine_y > 0 ? matrix(0, 0) / cosine_y : 1;
    const double sine_z = cosine_y > 0 ? matrix(1, 0) / cosine_y : 0;
    // x from what Rz^-1 leaves, not from the third row: that one is noise near cosine_y = 0.
    const double sine_x = sine_z * matrix(0, 2) - cosine_z * matrix(1, 2);
    const double cosine_x = cosine_z * matrix(1, 1) - sine_z * matrix(0, 1);
    const auto angle = [](double sine, double cosine) {
        const double value = std::atan2(sine, cosine) * (180.0 / pi<double>);
        return std::round(value * 1e12) / 1e12;  // 30.000000000000004 is 30
    };
    return {angle(sine_x, cosine_x), angle(-matrix(2, 0), cosine_y), angle(sine_z, cosine_z)};
}

}  // namespace pt
