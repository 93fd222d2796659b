// Random scenes whose numbers lie at the ends of what scene files allow, or beyond: each is refused in one line, or
// ends in an image without a sample that is NaN, infinite or negative. Seeded, so each run tries the same scenes.
#include <array>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/json_reader.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt::test {
namespace {

// Draws the members of a scene file: mostly what is allowed, often from the ends of it, now and then beyond.
class ExtremeScenes {
public:
    explicit ExtremeScenes(std::uint32_t seed) : random_(seed) {}

    Json scene() {
        Json objects = Json::array();
        Json materials;
        const int count = whole(1, 6);
        for (int i = 0; i < count; ++i) {
            const std::string name = fmt::format("m{}", i);
            materials[name] = material();
            objects.push_back(object(name, materials[name].at("type")));
        }
        return {{"name", "extreme"},  {"max_depth", whole(1, 12)}, {"environment", colour(radiances)},
                {"camera", camera()}, {"materials", materials},    {"objects", objects}};
    }

private:
    using Numbers = std::vector<double>;
    // What is allowed of each kind of number, its ends and denormals among it; `beyond` is allowed nowhere.
    inline static const Numbers beyond{-1, 1e19, 1e38, 1e300};
    inline static const Numbers fractions{0, 1e-310, 1e-45, 1e-40, 1e-38, 1e-20, 0.5, 0.999999999, 1};
    inline static const Numbers radiances{0, 1e-310, 1e-45, 1e-40, 1e-38, 1e-20, 1, 5, 1e10, 1e20, 1e30};
    inline static const Numbers sigmas{0, 1e-310, 1e-45, 1e-38, 1e-30, 1e-18, 1e-6, 1, 30, 1e6, 1e18};
    inline static const Numbers scales{1e-18, 1e-12, 1e-6, 1e-3, 0.5, 1, 2, 5, 1e3, 1e6, 1e12, 1e18};
    inline static const Numbers places{-1e18,  -1e9,  -1e3, -5, -1, -1e-6, -1e-40, 0,
                                       1e-310, 1e-38, 1e-6, 1,  3,  1e4,   1e18};
    inline static const Numbers near_places{-6, -3, -1, -0.5, 0, 1e-40, 0.25, 1, 2, 5, 8};
    inline static const Numbers iors{0.01, 0.5, 0.999999, 1, 1.000001, 1.5, 2.4, 100, 1e4};
    inline static const Numbers angles{-1e6, -90, 0, 1e-300, 1e-6, 30, 45, 89.999999, 90, 180, 1e6};

    int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
    bool one_in(int n) { return whole(1, n) == 1; }
    double from(const Numbers& numbers) {
        const Numbers& source = one_in(400) ? beyond : numbers;
        return source[static_cast<std::size_t>(whole(0, static_cast<int>(source.size()) - 1))];
    }
    Json colour(const Numbers& numbers) {
        const double grey = from(numbers);
        return one_in(2) ? Json{grey, grey, grey} : Json{from(numbers), from(numbers), from(numbers)};
    }
    Json place() { return one_in(2) ? colour(near_places) : colour(places); }

    Json camera() {
        Json camera{{"eye", one_in(6) ? place() : Json{0, 0, -9}},
                    {"look_at", one_in(6) ? place() : Json{0, 0, 0}},
                    {"up", one_in(8) ? place() : Json{0, 1, 0}},
                    {"vertical_fov_degrees", one_in(4) ? from({1e-6, 1e-3, 170, 179.999}) : 60},
                    {"resolution", {2, 2}},
                    {"jitter", one_in(2)}};
        if (one_in(3)) {
            camera["aperture_radius"] = from(scales);
            camera["focus_distance"] = from(scales);
        }
        if (one_in(3)) {
            camera["shutter"] = {{"open", from({-1e9, -1, 0, 1e-300, 1})}, {"close", from({1, 2, 1e9})}};
        }
        return camera;
    }

    Json material() {
        Json material;
        switch (whole(0, 8)) {
            case 0:
                material = {{"type", "diffuse"}, {"albedo", colour(fractions)}};
                break;
            case 1:
                return {{"type", "emitter"}, {"radiance", colour(radiances)}};
            case 2:
                material = {{"type", "mirror"}, {"reflectance", colour(fractions)}};
                break;
            case 3:
                material = {{"type", "mix"},
                            {"albedo", colour(fractions)},
                            {"reflectance", colour(fractions)},
                            {"mirror_probability", from(fractions)}};
                break;
            case 4:
                material = {
                    {"type", "rough_conductor"}, {"reflectance", colour(fractions)}, {"roughness", from(fractions)}};
                material["multiple_scattering"] = one_in(2);
                break;
            case 5:
                return {{"type", "dielectric"},
                        {"ior", from(iors)},
                        {"tint", colour(fractions)},
                        {"sigma_a", colour(sigmas)}};
            case 6:
                return {{"type", "principled"},
                        {"base_colour", colour(fractions)},
                        {"metallic", from(fractions)},
                        {"roughness", from(fractions)},
                        {"transmission", from(fractions)},
                        {"ior", from({1, 1 + 1e-6, 1.5, 1e4})}};
            case 7:
                return {{"type", "rough_dielectric"},
                        {"ior", from(iors)},
                        {"roughness", from(fractions)},
                        {"tint", colour(fractions)},
                        {"sigma_a", colour(sigmas)}};
            default:
                return {{"type", "subsurface"},
                        {"ior", from(iors)},
                        {"sigma_a", colour(sigmas)},
                        {"sigma_s", colour(sigmas)},
                        {"g", from({-0.9999, -0.5, 0, 1e-40, 1e-6, 0.5, 0.9999})},
                        {"max_scatterings", 50}};
        }
        if (one_in(2)) {
            material["emission"] = colour(radiances);
        }
        return material;
    }

    Json object(const std::string& material, const std::string& type) {
        const bool needs_inside =
            type == "dielectric" || type == "rough_dielectric" || type == "principled" || type == "subsurface";
        const std::array<const char*, 3> shapes{"sphere", "box", "quad"};
        Json object{{"shape", shapes[static_cast<std::size_t>(whole(0, needs_inside ? 1 : 2))]},
                    {"material", material},
                    {"translate", place()}};
        if (one_in(2)) {
            object["rotate_degrees"] = colour(angles);
        }
        object["scale"] = one_in(2) ? Json(from(scales)) : colour(scales);
        if (one_in(3)) {
            object["velocity"] = place();
        }
        return object;
    }

    std::mt19937 random_;
};

struct Kernel {
    const char* name;
    RenderOptions options;
};

// With the samplers' and the direct lights' code paths that read a scene's numbers.
std::vector<Kernel> kernels() {
    std::vector<Kernel> all{{"plain", {}},      {"final_bounce", {}}, {"next_event", {}}, {"mis", {}},
                            {"area", {}},       {"projected", {}},    {"auto", {}},       {"power", {}},
                            {"light_tree", {}}, {"one_sample", {}},   {"guided", {}}};
    all[1].options.final_bounce = true;
    all[2].options.next_event = true;
    all[3].options.next_event = true;
    all[3].options.mis_exponent = 2;
    all[3].options.roulette_start = 1;
    const LightSampling samplings[] = {LightSampling::area, LightSampling::projected, LightSampling::automatic};
    for (std::size_t i = 0; i < std::size(samplings); ++i) {
        all[4 + i].options = all[3].options;
        all[4 + i].options.light_sampling = samplings[i];
        all[4 + i].options.near_light = 20;
    }
    all[7].options = all[3].options;
    all[7].options.light_selection = LightSelection::power;
    all[8].options = all[3].options;
    all[8].options.light_selection = LightSelection::tree;
    all[9].options = all[3].options;
    all[9].options.one_sample = true;
    all[10].options.guided_share = 0.75;
    return all;
}

template <class Real>
void expect_no_faults(const Scene& scene, const Kernel& kernel, const std::string& text) {
    const FilmFaults faults = render<Real>(scene, kernel.options).faults();
    EXPECT_TRUE(faults.nonfinite == 0 && faults.negative == 0)
        << faults_text(faults) << ", " << kernel.name << ", " << 8 * sizeof(Real) << " bit: " << text;
}

TEST(ExtremeScenesTest, EndInAnImageOrInOneLine) {
    ExtremeScenes draw(20);
    constexpr int scenes = 30000;
    int accepted = 0;
    for (int i = 0; i < scenes && !HasFailure(); ++i) {
        const std::string text = draw.scene().dump();
        try {
            const Scene scene = parse_scene(text, "extreme.json");
            ++accepted;
            for (const Kernel& kernel : kernels()) {
                expect_no_faults<float>(scene, kernel, text);
                expect_no_faults<double>(scene, kernel, text);
            }
        } catch (const InputError& error) {
            const std::string line = error.what();
            EXPECT_TRUE(line.starts_with("extreme.json: $.") && line.find(", allowed: ") != std::string::npos &&
                        line.find('\n') == std::string::npos)
                << line;
        }
    }
    // Most scenes are accepted, and some are refused, so both ways are tested.
    EXPECT_GT(accepted, scenes / 2);
    EXPECT_LT(accepted, scenes);
}

// The scene's text with so many balls of 1 in a row that goes away from the camera.
std::string row_of_balls(std::size_t count) {
    std::string text =
        R"({"name":"row","max_depth":2,"environment":[1,1,1],"camera":{"eye":[0,0,-9],"look_at":[0,0,0],"up":[0,1,0],)"
        R"("vertical_fov_degrees":1,"resolution":[1,1]},"materials":{"m":{"type":"diffuse","albedo":[0.5,0.5,0.5]}},)"
        R"("objects":[)";
    for (std::size_t i = 0; i < count; ++i) {
        text += fmt::format(R"({}{{"shape":"sphere","material":"m","translate":[0,0,{}]}})", i == 0 ? "" : ",", 2 * i);
    }
    return text + "]}";
}

void expect_one_pixel_of(std::size_t count) {
    const Scene scene = parse_scene(row_of_balls(count), "row.json");
    EXPECT_EQ(scene.objects.size(), count);
    const Film film = render<float>(scene, {.depth = 1});
    EXPECT_TRUE(film.faults().none());
    EXPECT_EQ(film.pixel(0).x, 0);  // the first ball hides the environment, and a path of one segment ends on it
}

TEST(ExtremeScenesTest, AHundredThousandObjects) { expect_one_pixel_of(100'000); }
TEST(ExtremeScenesTest, AMillionObjects) { expect_one_pixel_of(1'000'000); }

TEST(ExtremeScenesTest, AHundredThousandMaterialsAndTheirObjects) {
    Json scene = Json::parse(row_of_balls(1));
    const Json material = scene["materials"]["m"];
    const Json ball = scene["objects"][0];
    for (int i = 0; i < 100'000; ++i) {
        const std::string name = fmt::format("n{}", i);
        scene["materials"][name] = material;
        scene["objects"].push_back(ball);
        scene["objects"].back()["material"] = name;
    }
    const Scene loaded = parse_scene(scene.dump(), "materials.json");
    EXPECT_EQ(loaded.materials[loaded.objects.back().material].name, "n99999");
    scene["objects"].back()["material"] = "none";
    try {
        parse_scene(scene.dump(), "materials.json");
        FAIL() << "an object of no material";
    } catch (const InputError& error) {
        EXPECT_LT(std::string(error.what()).size(), 400u) << error.what();
    }
}

TEST(ExtremeScenesTest, ImagesOfOneRowAndOneColumn) {
    SceneBuilder builder;
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, 0, 5}, 4);
    builder.environment(1).depth(3);
    for (const auto& [width, height] : {std::pair{65536u, 1u}, std::pair{1u, 65536u}}) {
        builder.scene.camera.width = width;
        builder.scene.camera.height = height;
        const Film film = render<float>(builder.scene, {});
        EXPECT_TRUE(film.faults().none()) << faults_text(film.faults());
        EXPECT_GT(film.mean().x, 0.2);
    }
}

// A white room that glows: every segment adds light, and nothing ends the path but its depth.
TEST(ExtremeScenesTest, DepthAHundredThousand) {
    constexpr std::uint32_t depth = 100'000;
    for (const double emission : {1e-30, 1.0, 1e30}) {
        SceneBuilder builder;
        builder.room(builder.diffuse(Vec3d(1.0), Vec3d(emission)), {0, 0, 0}, {3, 3, 3});
        builder.depth(depth);
        const Film film = render<float>(builder.scene, {});
        EXPECT_TRUE(film.faults().none()) << faults_text(film.faults());
        EXPECT_NEAR(film.pixel(0).x / emission, depth, 0.01 * depth);
    }
}

}  // namespace
}  // namespace pt::test
