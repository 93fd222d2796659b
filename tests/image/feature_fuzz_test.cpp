// Random scenes: the kernel that is chosen for a scene's features leaves the film of the generic one, to the last bit,
// rooms and all; on every CPU integrator.
#include <algorithm>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::Random;
using test::SceneBuilder;

constexpr int scenes = 900;
constexpr const char* integrators[] = {"depth_first", "packet", "wavefront", "packet"};
constexpr const char* direct_lights[] = {"final_bounce", "off", "nee_mis", "off", "nee"};

class RandomScene {
public:
    explicit RandomScene(std::uint64_t seed) : random_(seed) {
        builder_.image(8, 8, random_.uniform(30, 100), chance(0.7)).depth(1 + index(6));
        builder_.camera({random_.uniform(-1, 1), random_.uniform(-1, 1), -5}, {0, 0, 0});
        make_materials();
        if (chance(0.6)) {
            add_room();
        }
        const std::uint32_t objects = 1 + index(6);
        for (std::uint32_t i = 0; i < objects; ++i) {
            add_object();
        }
        builder_.sphere(lamp_, {random_.uniform(-2, 2), 1.5, random_.uniform(-1, 2)}, random_.uniform(0.2, 1));
        if (chance(0.1)) {
            builder_.environment(random_.uniform(0.1, 1));
        }
        if (chance(0.1)) {
            builder_.environment_map(2, 2, {colour(), colour(), colour() * 9.0, colour()}, random_.uniform(0, 360));
        }
        if (chance(0.15)) {
            builder_.scene.camera.aperture_radius = random_.uniform(0.01, 0.3);
            builder_.scene.camera.focus_distance = random_.uniform(2, 8);
        }
    }
    const Scene& scene() const { return builder_.scene; }

private:
    bool chance(double probability) { return random_.uniform() < probability; }
    std::uint32_t index(std::uint32_t count) {
        return std::min(count - 1, static_cast<std::uint32_t>(random_.uniform() * count));
    }
    Vec3d colour() { return {random_.uniform(0, 1), random_.uniform(0, 1), random_.uniform(0, 1)}; }

    void make_materials() {
        lamp_ = builder_.emitter(colour() * 5.0);
        materials_.push_back(builder_.diffuse(colour()));
        if (chance(0.7)) {
            materials_.push_back(builder_.mirror(colour()));
        }
        if (chance(0.25)) {
            materials_.push_back(builder_.mix(colour(), colour(), random_.uniform(0.1, 0.9)));
        }
        if (chance(0.3)) {
            materials_.push_back(builder_.dielectric(random_.uniform(1.1, 2), chance(0.3) ? colour() : Vec3d(0.0)));
        }
        if (chance(0.2)) {
            materials_.push_back(
                builder_.subsurface(colour() * 5.0, colour(), random_.uniform(-0.5, 0.5), chance(0.3) ? 1.4 : 1.0));
        }
        if (chance(0.25)) {
            materials_.push_back(builder_.rough_conductor(colour(), random_.uniform(0, 1), Vec3d(0.0), chance(0.3)));
        }
        if (chance(0.25)) {
            materials_.push_back(builder_.rough_dielectric(random_.uniform(1.1, 2), random_.uniform(0, 1),
                                                           chance(0.3) ? colour() : Vec3d(0.0)));
        }
        if (chance(0.3)) {
            materials_.push_back(builder_.principled(colour(), chance(0.5) ? 0 : random_.uniform(0, 1),
                                                     random_.uniform(0, 1), chance(0.5) ? 0 : random_.uniform(0, 1),
                                                     random_.uniform(1, 2)));
        }
        if (chance(0.1)) {
            materials_.push_back(builder_.diffuse(colour(), colour()));
        }
    }

    std::uint32_t material() { return materials_[index(static_cast<std::uint32_t>(materials_.size()))]; }

    // Walls round the middle, each there or not; some fit each other, some leave gaps or stand out.
    void add_room() {
        const double thickness = random_.uniform(0.01, 0.2);
        const double reach = chance(0.8) ? 6 : random_.uniform(5, 7);
        for (int axis = 0; axis < 3; ++axis) {
            for (const double side : {-3.0, 3.0}) {
                if (chance(0.15) || (axis == 2 && side < 0 && chance(0.8))) {
                    continue;  // open, as the side of the camera mostly is
                }
                Vec3d centre(0.0), scale(reach);
                centre[axis] = side;
                scale[axis] = thickness;
                builder_.box(materials_[0], centre, scale);
            }
        }
    }

    void add_object() {
        const Vec3d centre{random_.uniform(-2.5, 2.5), random_.uniform(-2.5, 2.5), random_.uniform(-2, 2.5)};
        const Vec3d scale{random_.uniform(0.1, 2), random_.uniform(0.1, 2), random_.uniform(0.1, 2)};
        const Vec3d turn = chance(0.5) ? Vec3d(0.0) : Vec3d(random_.uniform(0, 90), random_.uniform(0, 90), 0);
        switch (index(chance(0.6) ? 2 : 4)) {
            case 0:
                builder_.sphere(material(), centre, scale.x);
                break;
            case 1:
                builder_.box(material(), centre, scale, chance(0.7) ? Vec3d(0.0) : turn);
                break;
            case 2:
                builder_.ellipsoid(material(), centre, scale, turn);
                break;
            default:
                builder_.quad(materials_[0], centre, scale.x, scale.z, turn);
        }
        if (chance(0.05)) {
            builder_.scene.objects.back().velocity = colour();
            builder_.scene.camera.shutter_close = 0.5;
        }
    }

    Random random_;
    SceneBuilder builder_;
    std::uint32_t lamp_ = 0;
    std::vector<std::uint32_t> materials_;
};

TEST(FeatureFuzz, GenericAndFeaturesLeaveOneFilm) {
    int rooms = 0, specialised = 0, connected = 0, lit = 0;
    for (int seed = 0; seed < scenes; ++seed) {
        const RandomScene random(static_cast<std::uint64_t>(seed));
        const Scene& scene = random.scene();
        std::string expected;
        const std::string integrator = integrators[seed % 4];
        for (const char* specialisation : {"generic", "features"}) {
            RenderRequest request{
                .variant = Registry::instance().baseline(), .settings = default_settings(scene), .samples = 2};
            request.settings.seed = static_cast<std::uint64_t>(seed);
            // A packet is also to leave the film of a path at a time.
            request.variant.set("integrator", integrator == "packet" && expected.empty() ? "depth_first" : integrator);
            request.variant.set("direct_light", direct_lights[seed % std::size(direct_lights)]);
            request.variant.set("specialisation", specialisation);
            const RenderResult result = render(scene, request);
            if (expected.empty()) {
                expected = result.film.hash();
                lit += result.film.mean() != Vec3d(0.0) ? 1 : 0;
                continue;
            }
            ASSERT_EQ(result.film.hash(), expected) << "seed " << seed << ", " << request.variant.spelled_out() << ", "
                                                    << testing::PrintToString(feature_names(result.compiled));
            rooms += contains(result.compiled, Feature::enclosure) ? 1 : 0;
            const bool is_specialised = (result.compiled & all_features) != all_features;
            specialised += is_specialised ? 1 : 0;
            connected += is_specialised && result.work.connections > 0 ? 1 : 0;
        }
    }
    // The random scenes reach what they are for.
    EXPECT_GT(rooms, 30);
    EXPECT_GT(specialised, 100);
    EXPECT_GT(connected, 20);
    EXPECT_GT(lit, 250);
}

}  // namespace
}  // namespace pt
