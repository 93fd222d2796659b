#include "harness/interchange/import_mitsuba.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/interchange/import_mitsuba_shapes.h"
#include "harness/words.h"

namespace pt {

namespace {

// Path depth in place of Mitsuba's endless paths: with half the light lost per bounce, 2^-64 is left.
constexpr int depth_for_endless = 64;

// A camera's view as eye, look_at and up; `look_at_map` converts it to an affine map.
struct SensorView {
    Vec3d eye{0.0}, look_at{0, 0, 1}, up{0, 1, 0};
};

class MitsubaImporter {
public:
    MitsubaImporter(XmlElement& root, const ImportSource& source, ImportResult& result)
        : root_(&root), draft_(source, result), file_{&draft_, {}}, shapes_(file_) {}

    void import();

private:
    void fill_in(XmlElement& element);
    std::string filled(const XmlElement& element, std::string value);
    void modernise(XmlElement& element);
    void find_ids(const XmlElement& element);
    void read_integrator(const XmlElement& element);
    void read_sensor(const XmlElement& element);
    std::optional<SensorView> read_view(MitsubaObject& sensor);
    void read_film(MitsubaObject& sensor);
    void read_field_of_view(MitsubaObject& sensor);
    void read_lens(MitsubaObject& sensor);
    void read_emitter(const XmlElement& element);
    void read_envmap(const XmlElement& element);
    void read_top(const XmlElement& element);
    void note_unused();

    XmlElement* root_;
    ImportDraft draft_;
    MitsubaFile file_;
    MitsubaShapes shapes_;
    std::map<std::string, std::string> parameters_;
    const XmlElement *integrator_ = nullptr, *sensor_ = nullptr, *environment_ = nullptr;
    Vec3d eye_{0.0};
    double width_ = 768, height_ = 576;  // Mitsuba's default film size
};

// Replaces $NAME in an attribute's value by the value of an earlier <default>; the longest matching name wins.
std::string MitsubaImporter::filled(const XmlElement& element, std::string value) {
    constexpr std::size_t longest = 4096;
    for (std::size_t at = value.find('$'); at != std::string::npos && value.size() < longest;
         at = value.find('$', at)) {
        const auto is_named = [&](const auto& parameter) {
            return value.compare(at + 1, parameter.first.size(), parameter.first) == 0;
        };
        // The sorted names are searched backward, so that a longer name is found before one that is its prefix.
        const auto found = std::find_if(parameters_.rbegin(), parameters_.rend(), is_named);
        if (found == parameters_.rend()) {
            file_.refuse(element, fmt::format("a <default> before it that gives {} its value", value.substr(at)));
            return value;
        }
        value.replace(at, found->first.size() + 1, found->second);
        at += found->second.size();
    }
    return value;
}

void MitsubaImporter::fill_in(XmlElement& element) {
    for (auto& [name, value] : element.attributes) {
        if (value.find('$') != std::string::npos) {
            value = filled(element, value);
        }
    }
    constexpr std::size_t longest = 256;  // limit on an attribute value after substitution, against huge values
    if (element.tag == "default" && element.value_of("value").size() > longest) {
        file_.refuse(element, "a value of at most 256 letters");
    } else if (element.tag == "default") {
        parameters_.try_emplace(element.value_of("name"), element.value_of("value"));
    }
    for (XmlElement& child : element.children) {
        fill_in(child);
    }
}

// Converts camelCase names from before Mitsuba 2 to snake_case, as Mitsuba 3 does.
void MitsubaImporter::modernise(XmlElement& element) {
    for (auto& [key, value] : element.attributes) {
        if (key != "name") {
            continue;
        }
        std::string name;
        for (std::size_t i = 0; i < value.size(); ++i) {
            const bool is_capital = value[i] >= 'A' && value[i] <= 'Z';
            const bool starts_word = is_capital && i > 0 && value[i - 1] >= 'a' && value[i - 1] <= 'z';
            name += starts_word ? "_" : "";
            name += value[i];
        }
        value = in_lower_case(name);
    }
    for (XmlElement& child : element.children) {
        modernise(child);
    }
}

void MitsubaImporter::find_ids(const XmlElement& element) {
    const std::string* id = element.attribute("id");
    if (id != nullptr && element.tag != "ref" && !file_.by_id.emplace(*id, &element).second) {
        file_.refuse(element, fmt::format("the id \"{}\" once", *id));
    }
    for (const XmlElement& child : element.children) {
        find_ids(child);
        if (child.tag == "include" || child.tag == "alias" || child.tag == "path") {
            file_.refuse(child, "one file, whole, without <include>, <alias> and <path>");
        }
    }
    for (const XmlElement& child : element.children) {
        if (child.tag == "ref" && child.value_of("id").empty()) {
            file_.refuse(child, "a <ref> with an id");
        }
    }
}

void MitsubaImporter::read_integrator(const XmlElement& element) {
    MitsubaObject integrator(element, file_);
    const std::string type = integrator.type();
    if (type != "path" && type != "volpath" && type != "volpathmis" && type != "direct") {
        file_.refuse(element, "an integrator of type path, volpath, volpathmis or direct");
        return;
    }
    const XmlElement* at = integrator.property("max_depth");
    double depth = type == "direct" ? 2 : integrator.number("max_depth", -1);
    if (depth == -1) {
        depth = depth_for_endless;
        file_.warn(at != nullptr ? *at : element,
                   fmt::format("has paths without end: here they end at max_depth {}", depth_for_endless));
    }
    if (const XmlElement* roulette = integrator.property("rr_depth")) {
        if (!(integrator.number("rr_depth", 5) > depth)) {
            file_.note(*roulette, "is left out: Russian roulette is a choice of a run (--axis russian_roulette=..)");
        }
    }
    if (integrator.boolean("hide_emitters", false)) {
        integrator.fail(*integrator.property("hide_emitters"), "false: lamps are seen");
    }
    integrator.ignore({"shading_samples", "emitter_samples", "bsdf_samples"});
    integrator.finish("max_depth, rr_depth and hide_emitters");
    draft_.parts.root.add("max_depth", json_of(depth), file_.place(at != nullptr ? *at : element), "1");
}

void MitsubaImporter::read_film(MitsubaObject& sensor) {
    const std::vector<const XmlElement*> films = sensor.objects("film");
    for (const XmlElement* sampler : sensor.objects("sampler")) {
        file_.note(*sampler, "is left out: how many samples a pixel gets, and how they are drawn, is a run's business");
    }
    if (films.size() > 1) {
        sensor.fail(*films[1], "one film");
    }
    bool has_box = false;
    if (!films.empty()) {
        MitsubaObject film(*films.front(), file_);
        if (film.type() != "hdrfilm") {
            film.fail(film.element(), "a film of type hdrfilm");
        }
        width_ = film.number("width", width_);
        height_ = film.number("height", height_);
        for (const char* crop : {"crop_width", "crop_height", "crop_offset_x", "crop_offset_y"}) {
            film.refuse_property(crop, "no crop: the whole picture");
        }
        film.ignore({"file_format", "pixel_format", "component_format", "banner", "sample_border", "compensate"});
        for (const XmlElement* filter : film.objects("rfilter")) {
            has_box = filter->value_of("type") == "box";
        }
        film.finish("width, height and rfilter");
    }
    if (!has_box) {
        file_.warn(films.empty() ? sensor.element() : *films.front(),
                   "blurs: here a pixel is the mean of its own square, as with <rfilter type=\"box\"/>");
    }
    const Cis565Line* at = file_.place(films.empty() ? sensor.element() : *films.front());
    draft_.parts.camera.add("resolution", fmt::format("[{}, {}]", json_of(width_), json_of(height_)), at, "[1, 1]");
}

void MitsubaImporter::read_field_of_view(MitsubaObject& sensor) {
    const double aspect = width_ / height_;
    std::optional<double> angle = sensor.optional_number("fov");
    std::string axis = in_lower_case(sensor.text("fov_axis", "x"));
    const XmlElement* at = sensor.property("fov");
    if (!angle) {
        // Mitsuba's focal length of a camera refers to the diagonal of a 36 x 24 mm frame.
        std::string length = sensor.text("focal_length", "50mm");
        at = sensor.property("focal_length");
        length = length.ends_with("mm") ? length.substr(0, length.size() - 2) : length;
        const auto millimetres = mitsuba_numbers(length);
        if (!millimetres || millimetres->size() != 1 || !(millimetres->front() > 0)) {
            sensor.fail(*at, "a focal length such as 50mm");
            return;
        }
        angle = 2 * std::atan(std::sqrt(36.0 * 36 + 24 * 24) / (2 * millimetres->front())) * (180 / pi<double>);
        axis = "diagonal";
    }
    if (axis == "smaller" || axis == "larger") {
        axis = (aspect > 1) == (axis == "smaller") ? "y" : "x";
    }
    const double half = std::tan(*angle * (pi<double> / 360));
    double half_height = half;  // half the height of the camera's image plane at distance 1
    if (axis == "x") {
        half_height = half / aspect;
    } else if (axis == "diagonal") {
        half_height = half / std::sqrt(1 + aspect * aspect);
    } else if (axis != "y") {
        sensor.fail(*sensor.property("fov_axis"), "x, y, diagonal, smaller or larger");
    }
    const double vertical = axis == "y" ? *angle : std::atan(half_height) * (360 / pi<double>);
    draft_.parts.camera.add("vertical_fov_degrees", json_of(vertical),
                            file_.place(at != nullptr ? *at : sensor.element()), "60");
}

std::optional<SensorView> MitsubaImporter::read_view(MitsubaObject& sensor) {
    const Affine map = sensor.transform("to_world");
    const XmlElement* element = sensor.property("to_world");
    const XmlElement& at = element != nullptr ? *element : sensor.element();
    if (!sensor.is_good()) {
        return std::nullopt;
    }
    // A camera transform of a single lookat is read directly, without rounding through a matrix.
    if (element != nullptr && element->children.size() == 1 && element->children.front().tag == "lookat") {
        const XmlElement& look = element->children.front();
        const auto three = [&](const char* name) {
            const std::vector<double> numbers = mitsuba_numbers(look.value_of(name)).value_or(std::vector<double>(3));
            return Vec3d(numbers[0], numbers[1], numbers[2]);
        };
        return SensorView{three("origin"), three("target"), three("up")};
    }
    constexpr double slight = 1e-3;  // Mitsuba's tolerance for scale and shear in a camera transform
    double off = shear_of(map);
    for (const Vec3d& column : map.column) {
        off = std::max(off, std::abs(dot(column, column) - 1));
    }
    if (!is_finite(map) || !(off <= slight)) {
        sensor.fail(at, "for a sensor, a transform without scale and shear");
        return std::nullopt;
    }
    if (determinant(map) < 0) {
        sensor.fail(at, "for a sensor, a transform that does not mirror: no picture here is the wrong way round");
        return std::nullopt;
    }
    return SensorView{map.origin, map.origin + map.column[2], map.column[1]};
}

void MitsubaImporter::read_lens(MitsubaObject& sensor) {
    const std::optional<double> radius = sensor.optional_number("aperture_radius");
    const XmlElement *of_radius = sensor.property("aperture_radius"), *of_focus = sensor.property("focus_distance");
    const std::optional<double> focus = sensor.optional_number("focus_distance");
    if (!radius || !focus) {
        sensor.fail(sensor.element(), "a thinlens with aperture_radius and focus_distance");
        return;
    }
    draft_.parts.camera.add("aperture_radius", json_of(*radius), file_.place(*of_radius), "0");
    draft_.parts.camera.add("focus_distance", json_of(*focus), file_.place(*of_focus), "1");
}

void MitsubaImporter::read_sensor(const XmlElement& element) {
    MitsubaObject sensor(element, file_);
    const std::string type = sensor.type();
    if (type != "perspective" && type != "thinlens") {
        file_.refuse(element, "a sensor of type perspective or thinlens");
        return;
    }
    const SensorView view = read_view(sensor).value_or(SensorView());
    eye_ = view.eye;
    draft_.add_view(view.eye, view.look_at, view.up,
                    file_.place(sensor.property("to_world") != nullptr ? *sensor.property("to_world") : element));
    read_film(sensor);
    read_field_of_view(sensor);
    if (type == "thinlens") {
        read_lens(sensor);
    } else {
        sensor.ignore({"focus_distance"});
    }
    for (const char* offset : {"principal_point_offset_x", "principal_point_offset_y"}) {
        if (sensor.number(offset, 0) != 0) {
            sensor.refuse_property(offset, "0: the view goes through the picture's middle");
        }
    }
    // Clip distances are ignored, as camera rays start at the eye, and shutter times, as nothing in the import moves.
    sensor.ignore({"near_clip", "far_clip", "shutter_open", "shutter_close"});
    sensor.finish("what a " + type + " has here");
}

// Reads an environment map, which may only be rotated about y.
void MitsubaImporter::read_envmap(const XmlElement& element) {
    MitsubaObject emitter(element, file_);
    const std::string name = emitter.text("filename", "");
    const double scale = emitter.number("scale", 1);
    const Affine map = emitter.transform("to_world");
    emitter.ignore({"mis_compensation"});
    emitter.finish("filename, scale and to_world");
    const double degrees = std::atan2(map.column[2].x, map.column[0].x) * (180 / pi<double>);
    const Affine turn = rotation_about({0, 1, 0}, degrees);
    double off = 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3d difference = map.column[i] - turn.column[i];
        off = std::max(off, dot(difference, difference));
    }
    if (!(off < 1e-20)) {
        emitter.fail(element, "a to_world that turns about y alone");
    }
    if (name.empty()) {
        emitter.fail(element, "a file name");
    }
    if (!emitter.is_good()) {
        return;
    }
    const std::string file = draft_.path_of(name);
    try {
        if (read_environment_image(file).was_multiplied) {
            file_.warn(element,
                       "has an image with EXPOSURE or COLORCORR, which is divided out; Mitsuba passes over it");
        }
    } catch (const InputError& error) {
        emitter.fail(*emitter.property("filename"), fmt::format("an image that can be read ({})", error.what()));
        return;
    }
    file_.warn(element, "has the nearest texel's light along each direction; Mitsuba blends it with its neighbours'");
    draft_.parts.root.add(
        "environment",
        fmt::format("{{\"file\": {}, \"scale\": {}, \"rotation\": {}}}", json_of(draft_.name_in_scene(file)),
                    json_of(scale), json_of(shortest_within(degrees, 1e-12))),
        file_.place(element), "[0, 0, 0]");
}

void MitsubaImporter::read_emitter(const XmlElement& element) {
    const std::string type = element.value_of("type");
    if ((type != "constant" && type != "envmap") || environment_ != nullptr) {
        file_.refuse(element, environment_ != nullptr
                                  ? "one constant emitter or envmap"
                                  : "emitters of type constant or envmap, and of type area in shapes");
        return;
    }
    environment_ = &element;
    if (type == "envmap") {
        read_envmap(element);
        return;
    }
    MitsubaObject emitter(element, file_);
    const double scale = emitter.number("scale", 1);
    const Vec3d radiance = emitter.optional_radiance("radiance").value_or(Vec3d(1.0)) * scale;
    emitter.finish("radiance and scale");
    draft_.parts.root.add("environment", json_of(radiance), file_.place(element), "[0, 0, 0]");
}

void MitsubaImporter::read_top(const XmlElement& element) {
    const std::string& tag = element.tag;
    if (tag == "integrator" && integrator_ == nullptr) {
        integrator_ = &element;
    } else if (tag == "sensor" && sensor_ == nullptr) {
        sensor_ = &element;
    } else if (tag == "sensor") {
        file_.warn(element, "is left out: a scene has one sensor, the first");
    } else if (tag == "emitter") {
        read_emitter(element);
    } else if (tag == "shape") {
        shapes_.add(element);
    } else if (tag != "bsdf" && tag != "medium" && tag != "texture" && tag != "default" && tag != "include" &&
               tag != "alias" && tag != "path") {
        file_.refuse(element, "one integrator, sensors, emitters, shapes, bsdfs and media");
    }
}

void MitsubaImporter::note_unused() {
    const std::set<const XmlElement*> used = shapes_.materials().used();
    for (const XmlElement& element : root_->children) {
        if (element.tag == "bsdf" && !used.contains(&element)) {
            file_.note(element, "is left out: no shape has it");
        }
    }
}

void MitsubaImporter::import() {
    if (root_->tag != "scene") {
        file_.refuse(*root_, "<scene version=\"3.0.0\"> about all else");
        return;
    }
    const std::string version = root_->value_of("version");
    if (version.starts_with("0.") || version.starts_with("1.")) {
        modernise(*root_);
        file_.note(*root_, "is read as Mitsuba 3 reads it: names such as maxDepth as max_depth");
    }
    fill_in(*root_);
    find_ids(*root_);
    draft_.begin(std::filesystem::path(draft_.source().file).stem().string(), file_.place(*root_));
    for (const XmlElement& element : root_->children) {
        read_top(element);
    }
    if (sensor_ == nullptr) {
        file_.refuse(*root_, "a scene with a sensor");
    } else {
        read_sensor(*sensor_);
    }
    if (integrator_ != nullptr) {
        read_integrator(*integrator_);
    } else {
        draft_.parts.root.add("max_depth", json_of(double{depth_for_endless}), file_.place(*root_), "1");
        file_.warn(*root_, fmt::format("has no integrator: here paths end at max_depth {}", depth_for_endless));
    }
    shapes_.write(eye_);
    note_unused();
    if (sensor_ == nullptr) {
        draft_.finish();
        return;
    }
    if (const std::optional<Scene> scene = draft_.checked()) {
        shapes_.write_whole(*scene);
        (void)draft_.checked();
    }
    draft_.finish();
}

}  // namespace

ImportResult import_mitsuba(const ImportSource& source) {
    ImportResult result(source);
    if (std::optional<XmlElement> root = read_xml(source.text, result.problems)) {
        MitsubaImporter(*root, source, result).import();
    }
    return result;
}

bool is_like_mitsuba(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '<';
}

}  // namespace pt
