// specialisation=matrix does the same mathematics in other roundings: its paths meet what the classified objects' paths
// meet, but for the few that graze an edge (the issue allows one in 1e5).
#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "harness/scene/places.h"

namespace pt {
namespace {

Film film_of(const Scene& scene, const char* specialisation) {
    RenderRequest request{.variant = Registry::instance().baseline(), .settings = default_settings(scene)};
    request.settings.width = request.settings.height = 500;
    request.settings.seed = 3;
    request.variant.set("integrator", "depth_first");
    request.variant.set("specialisation", specialisation);
    return render(scene, request).film;
}

// Here a path's radiance is a product of colours, one a vertex: it is the same to the last bit as long as the path
// meets the same objects.
TEST(Matrix, MeetsTheSameObjects) {
    for (const char* name : {"cornell_open", "cornell_closed", "cornell_open_45"}) {
        const Scene scene = find_scene(name);
        const Film classified = film_of(scene, "features");
        const Film by_matrix = film_of(scene, "matrix");
        std::size_t differing = 0;
        for (std::uint32_t pixel = 0; pixel < 500 * 500; ++pixel) {
            differing += classified.pixel(pixel) != by_matrix.pixel(pixel) ? 1 : 0;
        }
        EXPECT_LE(static_cast<double>(differing), 1e-5 * 500 * 500) << name;
    }
}

// Whatever the shape and however it is turned: one path of few may go elsewhere, the mean may not.
TEST(Matrix, MeetsShapesTurnedAnyWay) {
    for (const char* name : {"cornell_open_five", "subsurface_box_on", "motion_on", "ball_glass"}) {
        const Scene scene = find_scene(name);
        const Vec3d classified = film_of(scene, "features").mean();
        const Vec3d by_matrix = film_of(scene, "matrix").mean();
        for (int channel = 0; channel < 3; ++channel) {
            // Paths that went elsewhere change the mean by no more than their share of the brightest radiance, 5.
            EXPECT_NEAR(by_matrix[channel], classified[channel], 5 * 1e-4) << name;
        }
    }
}

}  // namespace
}  // namespace pt
