// Imports the CAMERA section of a CIS 565 scene.
#include <cmath>

#include <fmt/format.h>

#include "harness/interchange/course_scene.h"
#include "harness/interchange/course_words.h"

namespace pt {

namespace {

// Adds eye, look_at and up. The three are valid only together: if one cannot be read, stand-ins replace all three.
void add_view(Cis565SectionReader& reader, ScenePart& camera, ImportResult& result) {
    const std::string view_key = reader.line("VIEW") != nullptr ? "VIEW" : "LOOKAT";
    const std::optional<Vec3d> eye = reader.required_vector("EYE");
    const std::optional<Vec3d> view = reader.required_vector(view_key);
    const std::optional<Vec3d> up = reader.required_vector("UP");
    const bool is_good = eye && view && up;
    const auto add = [&](const std::string& key, const Vec3d& value, const std::string& line, const Vec3d& stand_in) {
        camera.members.push_back({.key = key,
                                  .value = json_of(is_good ? value : stand_in),
                                  .line = is_good ? reader.line(line) : nullptr,
                                  .stand_in = json_of(stand_in),
                                  .is_of_view = true});
    };
    const Vec3d from = eye.value_or(Vec3d(0.0)), to = view.value_or(Vec3d(0.0));
    add("eye", from, "EYE", {0, 0, 1});
    add("look_at", view_key == "VIEW" ? from + to : to, view_key, {0, 0, 0});
    add("up", up.value_or(Vec3d(0.0)), "UP", {0, 1, 0});
    const Vec3d forward = view_key == "VIEW" ? to : to - from;
    if (is_good && (forward.x != 0 || forward.y != 0)) {
        const Cis565Line& line = *reader.line(view_key);
        result.notes.add(line.number, fmt::format("{} is read as it stands; the course's viewer turns a camera that "
                                                  "does not look along z in a way of its own",
                                                  line.text()));
    }
}

void add_resolution(Cis565SectionReader& reader, ScenePart& camera) {
    const std::string allowed = "RES and 2 whole numbers, width and height";
    std::optional<double> width, height;
    if (const Cis565Line* line = reader.required("RES")) {
        if (line->words.size() != 3) {
            reader.fail(*line, allowed);
        } else if ((width = reader.whole(*line, 1, allowed))) {
            height = reader.whole(*line, 2, allowed);
        }
    }
    const std::string stand_in = "[1, 1]";
    const bool is_good = width && height;
    camera.add("resolution", is_good ? fmt::format("[{}, {}]", json_of(*width), json_of(*height)) : stand_in,
               is_good ? reader.line("RES") : nullptr, stand_in);
}

// Radius and focus distance of the camera's thin lens, with the source lines that set them.
struct CourseLens {
    double radius = 0, focus = 0;
    const Cis565Line* radius_line = nullptr;
    const Cis565Line* focus_line = nullptr;
};

// Reads the camera's lens from a DOF line, which has the lens radius and the focus distance.
CourseLens lens_of_dof(Cis565SectionReader& reader, const Cis565Line& line) {
    if (line.words.size() != 3) {
        reader.fail(line, "DOF and 2 numbers, the lens's radius and the distance of focus");
        return {};
    }
    const double radius = reader.number_of({line.number, {line.words[0], line.words[1]}}).value_or(0);
    const double focus = reader.number_of({line.number, {line.words[0], line.words[2]}}).value_or(0);
    return {radius, focus, &line, &line};
}

// Reads the camera's lens. APERTURE is a diameter in texts, a factor beside a given radius, and a radius in JSON.
CourseLens read_lens(Cis565SectionReader& reader, bool is_json, ImportResult& result) {
    if (const Cis565Line* dof = reader.line("DOF")) {
        return lens_of_dof(reader, *dof);
    }
    CourseLens lens{reader.number("LENSRADIUS"), reader.number("FOCALDIST"), reader.line("LENSRADIUS"),
                    reader.line("FOCALDIST")};
    const Cis565Line* aperture = reader.line("APERTURE");
    const double opening = reader.number("APERTURE");
    if (aperture == nullptr) {
        return lens;
    }
    const bool has_radius = lens.radius_line != nullptr;
    lens.radius = has_radius ? lens.radius * opening : is_json ? opening : opening / 2;
    lens.radius_line = aperture;
    if (lens.radius > 0) {
        result.warnings.add(aperture->number, fmt::format("{} is read as {}: programs differ", aperture->text(),
                                                          has_radius ? "a factor of the lens's radius"
                                                          : is_json  ? "the lens's radius"
                                                                     : "the lens's diameter"));
    }
    return lens;
}

void add_lens(const CourseImport& import, Cis565SectionReader& reader, ScenePart& camera) {
    CourseLens lens = read_lens(reader, import.sections->is_json, *import.result);
    const auto use = import.sections->settings.lines.find("DOF");
    const bool is_off = use != import.sections->settings.lines.end() && is_course_off("DOF", use->second.values());
    if (is_off || lens.radius == 0) {
        return;
    }
    if (lens.focus == 0) {
        const std::optional<Vec3d> eye = reader.required_vector("EYE");
        const Cis565Line* at = reader.line(reader.line("VIEW") != nullptr ? "VIEW" : "LOOKAT");
        const Vec3d to = at == nullptr ? Vec3d(0.0) : reader.vector_of(*at).value_or(Vec3d(0.0));
        const Vec3d reach = reader.line("VIEW") != nullptr ? to : to - eye.value_or(Vec3d(0.0));
        lens.focus = std::sqrt(dot(reach, reach));
        lens.focus_line = nullptr;
        import.result->warnings.add(lens.radius_line->number,
                                    fmt::format("{} without a distance of focus: sharp at the point looked at, {:.6g} "
                                                "away",
                                                lens.radius_line->text(), lens.focus));
    }
    camera.add("aperture_radius", json_of(lens.radius), lens.radius_line, "0");
    camera.add("focus_distance", json_of(lens.focus), lens.focus_line, "1");
}

}  // namespace

ScenePart import_camera(const CourseImport& import) {
    const Cis565Section& section = *import.sections->camera;
    ScenePart camera{.place = "$.camera", .head = &section.head, .members = {}};
    Cis565SectionReader reader(section, import.result->problems);
    add_view(reader, camera, *import.result);
    const std::optional<double> half_angle = reader.required_number("FOVY");
    camera.add("vertical_fov_degrees", json_of(2 * half_angle.value_or(30)), half_angle ? reader.line("FOVY") : nullptr,
               "60");
    add_resolution(reader, camera);
    add_lens(import, reader, camera);
    if (const CourseMotion& motion = import.motion; motion.first != nullptr) {
        const char* density = motion.is_late ? "late" : "uniform";
        camera.add("shutter", fmt::format("{{\"open\": 0, \"close\": 1, \"density\": \"{}\"}}", density), nullptr);
        import.result->warnings.add(
            motion.first->number,
            fmt::format("{}: the file does not say when the shutter is open; it is open from 0 to 1 with the density "
                        "\"{}\"",
                        motion.first->text(), density));
    }
    (void)reader.number("ITERATIONS");  // ITERATIONS, the sample count, is not used but must be a number
    camera.is_whole = reader.is_whole();
    return camera;
}

}  // namespace pt
