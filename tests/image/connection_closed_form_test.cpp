// What connections bring, so exactly that an error of 1 % fails: the irradiance of a point by lights of every shape,
// which has closed forms, for every way to draw a point on a light, to choose a light and to weigh a connection; and by
// way of other materials, against light that is met. Tests of whole images (next_event_test.cpp) see some per cent.
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::Mean;
using test::RenderOptions;
using test::SceneBuilder;

constexpr double albedo = 0.75;

// Lambert's formula: the integral of the direction over the solid angle of a polygon, seen from the origin.
Vec3d vector_irradiance(const std::vector<Vec3d>& corners) {
    Vec3d sum(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& a = corners[i];
        const Vec3d& b = corners[(i + 1) % corners.size()];
        const Vec3d across = cross(a, b);
        const double length = std::sqrt(dot(across, across));
        sum += across * (0.5 * std::atan2(length, dot(a, b)) / length);
    }
    return sum;
}

// The irradiance at the origin, facing up, by an object of radiance 1 with this outline, wholly above the horizon.
double of_outline(const std::vector<Vec3d>& corners) { return std::abs(vector_irradiance(corners).y); }

Vec3d to_world(const SceneObject& object, const Vec3d& local) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    const Vec3d at = local * object.scale;
    return object.translate + rotation.column[0] * at.x + rotation.column[1] * at.y + rotation.column[2] * at.z;
}

// The irradiance at the origin by an object's face across `axis`, at half the extent times `side`. Unless `always`, a
// face that is turned away from the origin counts for nothing.
double face(const SceneObject& object, int axis, double side, bool always) {
    std::vector<Vec3d> corners;
    for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        Vec3d local(0.5 * side);
        local[(axis + 1) % 3] = u;
        local[(axis + 2) % 3] = v;
        corners.push_back(to_world(object, local));
    }
    const Vec3d outwards = rotation_of(object.rotate_degrees).column[axis] * side;
    return always || dot(outwards, corners[0]) < 0 ? of_outline(corners) : 0;
}

double box(const SceneObject& object) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        sum += face(object, axis, -1, false) + face(object, axis, 1, false);
    }
    return sum;
}

// Rays that touch the unit sphere from o do so on a circle around o / o^2.
double ellipsoid(const SceneObject& object) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    Vec3d o;
    for (int axis = 0; axis < 3; ++axis) {
        o[axis] = -2 * dot(rotation.column[axis], object.translate) / object.scale[axis];
    }
    const double square = dot(o, o), radius = std::sqrt(1 - 1 / square);
    const Vec3d across = normalize(cross(o, std::abs(o.x) < std::abs(o.y) ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
    const Vec3d further = normalize(cross(o, across));
    std::vector<Vec3d> outline;
    for (int i = 0; i < 4096; ++i) {
        const double turn = 2 * pi<double> * i / 4096;
        const Vec3d at = o / square + (across * std::cos(turn) + further * std::sin(turn)) * radius;
        outline.push_back(to_world(object, at * 0.5));
    }
    return of_outline(outline);
}

double irradiance(const SceneObject& object) {
    if (object.shape == Shape::box) {
        return box(object);
    }
    if (object.shape == Shape::quad) {
        return face(object, 1, 0, true);
    }
    // All meshes of these scenes are test::square_mesh.
    return object.shape == Shape::mesh ? face(object, 2, 0, true) : ellipsoid(object);
}

// The camera sees one point, the origin, of a diffuse floor; from the side (-x, -z), where no light is.
SceneBuilder floor_alone() {
    SceneBuilder builder;
    builder.camera({-3, 0.5, -3}, {0, 0, 0});
    builder.quad(builder.diffuse(Vec3d(albedo)), {0, 0, 0}, 10, 10);
    return builder;
}

// The radiance of that point, lit by all objects but the floor, none of which hides any other, before an even sky.
Vec3d exact_radiance(const Scene& scene, double sky = 0) {
    Vec3d sum(pi<double> * sky);
    for (std::size_t i = 1; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        sum += (scene.materials[object.material].emission - Vec3d(sky)) * irradiance(object);
    }
    return sum * (albedo / pi<double>);
}

struct Technique {
    const char* name;
    std::uint32_t mis_exponent;
    bool one_sample;
};
constexpr Technique sums[] = {{"nee", 0, false}, {"nee_mis, balance", 1, false}, {"nee_mis, power", 2, false}};

struct WayToLight {
    const char* name;
    LightSampling sampling;
    std::uint16_t near_light;
};
constexpr WayToLight by_solid_angle{"solid_angle", LightSampling::solid_angle, 0};
constexpr WayToLight ways_to_light[] = {by_solid_angle,
                                        {"area", LightSampling::area, 0},
                                        {"projected", LightSampling::projected, 0},
                                        {"auto, far", LightSampling::automatic, 20},
                                        {"auto, near", LightSampling::automatic, 400}};

struct WayToChoose {
    const char* name;
    LightSelection selection;
};
constexpr WayToChoose uniformly{"uniform", LightSelection::uniform};
constexpr WayToChoose ways_to_choose[] = {
    uniformly, {"power", LightSelection::power}, {"light_tree", LightSelection::tree}};

// One combination: its scene, its exact radiance, and how it is estimated.
struct Case {
    const Scene& scene;
    Vec3d exact;
    Technique technique;
    WayToLight light = by_solid_angle;
    WayToChoose choice = uniformly;

    std::string name() const { return std::string(choice.name) + ", " + light.name + ", " + technique.name; }
    RenderOptions options() const {
        RenderOptions options;
        options.depth = 2;
        options.next_event = true;
        options.mis_exponent = technique.mis_exponent;
        options.one_sample = technique.one_sample;
        options.light_sampling = light.sampling;
        options.near_light = light.near_light;
        options.light_selection = choice.selection;
        // Numbers that fill the unit cube evenly: a few thousand samples see what takes a million plain ones. But which
        // technique is chosen is noise of its own, which they do not make even.
        options.sampler = technique.one_sample ? no_features : set_of(Feature::sobol_owen);
        return options;
    }
};

// Means of sets of samples, each scrambled by a seed of its own: only between sets does their spread tell the error.
template <class Real>
test::ColourMean means_of_sets(const Scene& scene, RenderOptions options, std::uint32_t samples) {
    options.samples = samples;
    test::ColourMean means;
    for (std::uint32_t set = 0; set < 16; ++set) {
        options.seed = 100 + set;
        const test::ColourMean mean = test::mean_radiance<Real>(scene, options);
        means.add({mean.channel[0].value(), mean.channel[1].value(), mean.channel[2].value()});
    }
    return means;
}

// `largest_error`: the standard error may be that much of the exact value.
void expect_exact(const test::ColourMean& means, const Vec3d& exact, double largest_error, const std::string& what) {
    for (int i = 0; i < 3; ++i) {
        const Mean& mean = means.channel[i];
        // The outlines of ellipsoids are polygons, and floats round: 2e-6.
        EXPECT_NEAR(mean.value(), exact[i], test::tolerated_errors * mean.standard_error() + 2e-6 * exact[i]) << what;
        EXPECT_LT(mean.standard_error(), largest_error * exact[i]) << what;
    }
}

// `samples`: in each of 16 sets.
template <class Real>
void expect_exact(const Case& c, std::uint32_t samples, double largest_error, const std::string& what = "") {
    expect_exact(means_of_sets<Real>(c.scene, c.options(), samples), c.exact, largest_error, what + c.name());
}

template <class Real>
class ConnectionTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ConnectionTest, Reals);

using AddLight = std::function<void(SceneBuilder&, std::uint32_t)>;

// Small lights of every shape, around the floor's normal; from the origin none hides another. Light that scatters meets
// them rarely.
const AddLight small_lights[] = {
    [](auto& b, auto m) {
        b.sphere(m, {0.9, 1.4, -0.6}, 0.6);
    },
    [](auto& b, auto m) {
        b.ellipsoid(m, {-0.9, 1.6, 0.9}, {0.8, 0.3, 0.5}, {20, 30, 40});
    },
    [](auto& b, auto m) {
        b.box(m, {1.2, 0.6, 1.2}, {0.5, 0.4, 0.6});
    },
    [](auto& b, auto m) {
        b.box(m, {0, 0.8, -1.4}, {0.4, 0.5, 0.3}, {20, 30, 40});
    },
    [](auto& b, auto m) {
        b.quad(m, {0, 2, 0}, 1, 0.6);
    },
    [](auto& b, auto m) {
        b.quad(m, {-1.5, 0.8, 0.2}, 0.7, 0.5, {60, 20, 90});
    },
    [](auto& b, auto m) {
        b.mesh(m, test::square_mesh(), {0.2, 0.9, 1.6}, 0.6, {30, 170, 10});
    },
};
// Met by about half of the light that scatters: there both techniques count.
const AddLight large_lights[] = {
    [](auto& b, auto m) {
        b.sphere(m, {0.3, 1.2, 0.2}, 2);
    },
    [](auto& b, auto m) {
        b.box(m, {0.2, 1.25, 0.1}, {2, 0.5, 2});
    },
    [](auto& b, auto m) {
        b.quad(m, {0.2, 0.7, 0.1}, 1.5, 1, {5, 20, 10});
    },
};

TEST(ConnectionFormulaTest, FormulasGiveThePagesNumbers) {
    // numerics.md S6, S8: those of irradiance_test.cpp.
    SceneBuilder b;
    const std::uint32_t m = b.emitter(Vec3d(1.0));
    EXPECT_NEAR(irradiance(b.quad(m, {0.5, 1, 0.5}, 1, 1)), .4352098756835515, 1e-14);
    EXPECT_NEAR(irradiance(b.quad(m, {0.5, 1, 0.5}, 1, 1, {180, 0, 0})), .4352098756835515, 1e-14);
    EXPECT_NEAR(irradiance(b.quad(m, {1, .5, .5}, 2, 1)), .693593356403909, 1e-14);
    EXPECT_NEAR(irradiance(b.box(m, {0, 1.25, 0}, {2, 0.5, 2}, {0, 30, 0})), 1.740839502734206, 1e-14);
    const double w = pi<double> / 2 - 0.7;
    const Vec3d centre{2 * std::cos(w), 2 * std::sin(w), 0};
    EXPECT_NEAR(irradiance(b.sphere(m, {0, 2, 0}, 2)), .785398163, 1e-6);
    EXPECT_NEAR(irradiance(b.sphere(m, centre, 2)), pi<double> / 4 * std::sin(w), 1e-6);
}

// The ways to draw points are those of boxes and quads; others have one.
bool has_ways(const SceneObject& light) { return light.shape == Shape::box || light.shape == Shape::quad; }

template <class Real>
void expect_of_one(const AddLight& add_light, std::uint32_t samples, double largest_error, const std::string& what) {
    SceneBuilder builder = floor_alone();
    add_light(builder, builder.emitter({4, 2, 1}));
    const Vec3d exact = exact_radiance(builder.scene);
    for (const WayToLight& way : ways_to_light) {
        for (const Technique& technique : sums) {
            expect_exact<Real>({builder.scene, exact, technique, way}, samples, largest_error, what);
        }
        if (!has_ways(builder.scene.objects[1])) {
            break;
        }
    }
}

TYPED_TEST(ConnectionTest, ToASmallLightOfEveryShape) {
    for (std::size_t i = 0; i < std::size(small_lights); ++i) {
        expect_of_one<TypeParam>(small_lights[i], 512, 0.001, "light " + std::to_string(i) + ", ");
    }
}

TYPED_TEST(ConnectionTest, ToALargeLight) {
    for (std::size_t i = 0; i < std::size(large_lights); ++i) {
        expect_of_one<TypeParam>(large_lights[i], 1024, 0.0007, "light " + std::to_string(i) + ", ");
    }
}

// All small lights, each in a colour of its own.
SceneBuilder many_lights() {
    SceneBuilder builder = floor_alone();
    const Vec3d colours[] = {{4, 1, 0.5}, {2, 3, 1}, {1, 2, 4}, {3, 5, 2}, {0.5, 1, 1}, {2, 0.5, 3}, {1, 4, 2}};
    for (std::size_t i = 0; i < std::size(small_lights); ++i) {
        small_lights[i](builder, builder.emitter(colours[i]));
    }
    return builder;
}

TYPED_TEST(ConnectionTest, ToOneOfManyLights) {
    const Scene scene = many_lights().scene;
    const Vec3d exact = exact_radiance(scene);
    for (const WayToChoose& choice : ways_to_choose) {
        for (const WayToLight& way : ways_to_light) {
            for (const Technique& technique : sums) {
                expect_exact<TypeParam>({scene, exact, technique, way, choice}, 2048, 0.001);
            }
        }
    }
}

// The last vertex of a final bounce is connected to one light too.
TYPED_TEST(ConnectionTest, OfAFinalBounce) {
    const auto expect = [](const SceneBuilder& builder, const std::string& what) {
        RenderOptions options;
        options.depth = 1;
        options.final_bounce = true;
        options.sampler = set_of(Feature::sobol_owen);
        const auto means = means_of_sets<TypeParam>(builder.scene, options, 16384);
        expect_exact(means, exact_radiance(builder.scene), 0.001, what);
    };
    expect(many_lights(), "many lights");
    for (std::size_t i = 0; i < std::size(large_lights); ++i) {
        SceneBuilder builder = floor_alone();
        large_lights[i](builder, builder.emitter({4, 2, 1}));
        expect(builder, "light " + std::to_string(i));
    }
}

// It takes a million samples. OneSampleCountsTheChosenTechniqueTwice of next_event_test.cpp is exact, but for how often
// each is chosen.
TEST(OneSampleConnectionTest, ChoosesEachTechniqueAsOften) {
    const Scene scene = many_lights().scene;
    const Vec3d exact = exact_radiance(scene);
    for (std::uint32_t i = 0; i < std::size(ways_to_choose); ++i) {
        const Technique technique{"one sample", 1 + i % 2, true};
        expect_exact<float>({scene, exact, technique, ways_to_light[2 * i], ways_to_choose[i]}, 100000, 0.0015);
    }
}

// The sky brings more than all lights. Below the floor it brings nothing, but is drawn as well.
TYPED_TEST(ConnectionTest, ToOneOfManyLightsOrTheSky) {
    const double sky = 2;
    SceneBuilder builder = many_lights();
    builder.environment_map(2, 2, {Vec3d(sky), Vec3d(sky), Vec3d(0.5), Vec3d(0.125)});
    const Vec3d exact = exact_radiance(builder.scene, sky);
    for (const WayToChoose& choice : ways_to_choose) {
        for (const Technique& technique : sums) {
            expect_exact<TypeParam>({builder.scene, exact, technique, by_solid_angle, choice}, 8192,
                                    technique.mis_exponent == 0 ? 0.0013 : 0.0005);
        }
    }
}

// A point of a quad of any material, seen slantwise, between lights above and below it: what is near the mirror's
// direction, what is off it, what is seen through the surface, and the sky all round.
template <class AddMaterial>
Scene between_lights(const AddMaterial& add_material, double sky) {
    SceneBuilder builder;
    builder.camera({-2, 2, -2}, {0, 0, 0}).depth(2);
    builder.quad(add_material(builder), {0, 0, 0}, 0.2, 0.2);
    builder.sphere(builder.emitter({4, 5, 6}), {0.9, 1.1, 0.8}, 1.4);
    builder.quad(builder.emitter({3, 2, 1}), {-0.7, 1.3, 0.9}, 1, 0.8, {30, 20, 10});
    builder.box(builder.emitter({1, 2, 3}), {0.4, -1, 0.6}, {1.2, 0.5, 1.5}, {10, 20, 0});
    if (sky > 0) {
        builder.environment_map(2, 2, {Vec3d(sky), Vec3d(0.5 * sky), Vec3d(0.25 * sky), Vec3d(sky)});
    }
    return builder.scene;
}

// Lights are wide enough to be met often: what meeting them brings is as exact a reference. With multiple importance
// sampling few samples do.
template <class Real>
void expect_as_met(const Scene& scene, const std::string& what) {
    RenderOptions plain;
    plain.depth = 2;
    plain.sampler = set_of(Feature::sobol_owen);
    const auto met = means_of_sets<Real>(scene, plain, 4096);
    for (const Technique& technique : {sums[0], sums[1]}) {
        const Case c{scene, {}, technique};
        const auto means = means_of_sets<Real>(scene, c.options(), technique.mis_exponent == 0 ? 8192 : 1024);
        for (int i = 0; i < 3; ++i) {
            const Mean& a = met.channel[i];
            const Mean& b = means.channel[i];
            const double error = std::hypot(a.standard_error(), b.standard_error());
            EXPECT_NEAR(b.value(), a.value(), test::tolerated_errors * error) << what << c.name();
            EXPECT_LT(error, 0.002 * a.value()) << what << c.name();
        }
    }
}

TYPED_TEST(ConnectionTest, ByEveryLobe) {
    const Vec3d colour{0.9, 0.7, 0.4};
    const std::pair<const char*, std::function<std::uint32_t(SceneBuilder&)>> materials[] = {
        {"mix",
         [&](auto& b) {
             return b.mix({0.75, 0.5, 0.25}, colour, 0.4);
         }},
        {"conductor", [&](auto& b) { return b.rough_conductor(colour, 0.6); }},
        {"conductor, many bounces", [&](auto& b) { return b.rough_conductor(colour, 0.8, Vec3d(0.0), true); }},
        {"dielectric", [&](auto& b) { return b.rough_dielectric(1.5, 0.7); }},
        {"principled", [&](auto& b) { return b.principled(colour, 0.4, 0.6); }},
        {"principled, narrow", [&](auto& b) { return b.principled(colour, 0.2, 0.05); }},
        {"principled, part glass", [&](auto& b) { return b.principled(colour, 0.2, 0.7, 0.6); }},
    };
    // In one precision with the sky, in the other without: what either sees, it sees in both.
    const double sky = std::is_same_v<TypeParam, float> ? 2 : 0;
    for (const auto& [name, add_material] : materials) {
        expect_as_met<TypeParam>(between_lights(add_material, sky), name + std::string(", "));
    }
}

}  // namespace
}  // namespace pt
