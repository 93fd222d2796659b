// Camera rays of imported scenes beside the formulas of the course's programs: scene.cpp has yscaled = tan(FOVY) and
// pixelLength = 2 (xscaled, yscaled) / resolution, pathtrace.cu rays to view - right pixelLength.x (x - width / 2) - up
// pixelLength.y (y - height / 2), whose picture is written from right to left; students' lenses start rays on a disk
// and aim them at focalDistance / dot(direction, view) along the plain ray. At pixels' centres.
#include <cmath>

#include <gtest/gtest.h>

#include "harness/interchange/import_course_json.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/camera.h"
#include "tests/support/cis565_texts.h"

namespace pt {
namespace {

using test::plain_camera, test::replaced, test::with_material;

struct CourseCamera {
    Vec3d view, right, up;
    double pixel_x, pixel_y;
    double width, height;

    CourseCamera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up_given, double fovy, double w, double h)
        : view(normalize(look_at - eye)), right(normalize(cross(view, up_given))), up(up_given), width(w), height(h) {
        const double yscaled = std::tan(fovy * (pi<double> / 180)), xscaled = (yscaled * w) / h;
        pixel_x = 2 * xscaled / w;
        pixel_y = 2 * yscaled / h;
    }
    Vec3d direction(double x, double y) const {
        return normalize(view + right * (pixel_x * (x + 0.5 - width / 2)) - up * (pixel_y * (y + 0.5 - height / 2)));
    }
};

void expect_near(const Vec3d& a, const Vec3d& b) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(a[axis], b[axis], 1e-14) << axis;
    }
}

const CourseCamera course({1, 2, 3}, {1, 2, 0}, {0, 1, 0}, 30, 40, 30);

template <class Check>
void for_some_pixels(const Scene& scene, const Check& check) {
    const SceneBuffers<double> buffers(scene, default_settings(scene));
    for (std::uint32_t index = 0; index < 40 * 30; index += 37) {
        const PixelPlace place = PixelPlace::of(index, 40);
        using Lens = Config<double, static_cast<FeatureSet>(Feature::lens)>;
        check(camera_path<Lens>(buffers.view().camera, RandomSeed::from(1), place, 0, 0), place);
    }
}

Scene scene_of(const std::string& camera_lines) {
    const std::string text = replaced(with_material("RGB 1 1 1\n"), "DEPTH 5\n", "DEPTH 5\n" + camera_lines);
    return parse_scene(import_cis565_scene(text, "a.txt").json, "scene.json");
}

TEST(ImportCourseCamera, RaysGoWhereTheCoursesGo) {
    for_some_pixels(scene_of(""), [](const Path<double>& path, const PixelPlace& place) {
        expect_near(path.direction, course.direction(place.x, place.y));
    });
}

TEST(ImportCourseCamera, LensesAreTheStudentsLenses) {
    for_some_pixels(scene_of("LENSRADIUS .25\nFOCALDIST 7\n"), [](const Path<double>& path, const PixelPlace& place) {
        const Vec3d plain = course.direction(place.x, place.y);
        const Vec3d sharp = plain * (7 / dot(plain, course.view));
        EXPECT_LE(dot(path.origin, path.origin), 0.25 * 0.25);
        EXPECT_NEAR(dot(path.origin, course.view), 0, 1e-15);
        expect_near(path.direction, normalize(sharp - path.origin));
    });
}

}  // namespace
}  // namespace pt
