// The scenes that come with the program: each loads, is what its name says, and has a kernel of its own on the CPU.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "tests/support/places.h"

namespace pt {
namespace {

const std::filesystem::path source_folder = test::source_folder();

std::vector<std::filesystem::path> scene_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(source_folder / "scenes")) {
        if (entry.path().extension() == ".json") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

Scene shipped(const std::string& name) { return load_scene((source_folder / "scenes" / (name + ".json")).string()); }

std::string names_of(FeatureSet features) {
    std::string joined;
    for (const std::string& name : feature_names(features)) {
        joined += (joined.empty() ? "" : " ") + name;
    }
    return joined;
}

FeatureSet feature_named(const std::string& name) {
    for (int bit = 0; bit < 64; ++bit) {
        if (feature_names(FeatureSet{1} << bit) == std::vector<std::string>{name}) {
            return FeatureSet{1} << bit;
        }
    }
    ADD_FAILURE() << "no feature " << name;
    return no_features;
}

// The lines of cpu_feature_sets.txt.
std::vector<FeatureSet> listed_sets() {
    std::ifstream stream(source_folder / "variants/specialisation/cpu_feature_sets.txt");
    std::vector<FeatureSet> sets;
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line[0] == '#') {
            continue;
        }
        FeatureSet features = no_features;
        std::istringstream words(line);
        for (std::string word; words >> word;) {
            features |= feature_named(word);
        }
        sets.push_back(features);
    }
    return sets;
}

TEST(ShippedScenes, AreThere) { EXPECT_GE(scene_files().size(), 25u); }

TEST(ShippedScenes, LoadAndAreNamedAsTheirFiles) {
    for (const std::filesystem::path& file : scene_files()) {
        const Scene scene = load_scene(file.string());
        EXPECT_EQ(scene.name, file.stem().string());
        EXPECT_FALSE(scene.description.empty()) << scene.name;
        EXPECT_EQ(scene.description.find('\n'), std::string::npos) << scene.name;
        EXPECT_EQ(scene.camera.width, 800u) << scene.name;
        EXPECT_EQ(scene.camera.height, 800u) << scene.name;
    }
}

TEST(ShippedScenes, HaveNoMaterialThatNothingIsMadeOf) {
    for (const std::filesystem::path& file : scene_files()) {
        const Scene scene = load_scene(file.string());
        std::set<std::uint32_t> used;
        for (const SceneObject& object : scene.objects) {
            used.insert(object.material);
        }
        EXPECT_EQ(used.size(), scene.materials.size()) << scene.name;
    }
}

TEST(ShippedScenes, HaveExactKernelsOfEveryIntegrator) {
    for (const Choice* integrator : Registry::instance().choices("integrator")) {
        if (integrator->descriptor.name == "audited") {  // for health, not for times: generic kernels alone
            continue;
        }
        for (const std::filesystem::path& file : scene_files()) {
            const FeatureSet features = features_of(load_scene(file.string()));
            EXPECT_TRUE(integrator->hook.integrator.contains(features))
                << file.stem() << " needs a line in cpu_feature_sets.txt: " << names_of(features);
        }
    }
}

TEST(ShippedScenes, NeedEveryListedFeatureSet) {
    constexpr FeatureSet estimators = Feature::final_bounce | Feature::next_event | Feature::multiple_importance |
                                      Feature::projected_sampling | Feature::automatic_sampling |
                                      Feature::power_selection | Feature::tree_selection;
    std::set<FeatureSet> needed;
    for (const std::filesystem::path& file : scene_files()) {
        needed.insert(features_of(load_scene(file.string())));
    }
    needed.insert(features_of(shipped("meshes/icosphere_room")));
    std::set<FeatureSet> listed;
    for (const FeatureSet features : listed_sets()) {
        EXPECT_TRUE(listed.insert(features).second) << "listed twice: " << names_of(features);
        const FeatureSet of_scene = features & ~(shortcuts | estimators);
        EXPECT_TRUE(needed.contains(of_scene)) << "no scene needs " << names_of(features);
    }
}

// On every CPU integrator, so that what direct light costs there is not the price of a kernel for every scene.
TEST(ShippedScenes, OfTheBoxesHaveKernelsWithDirectLight) {
    for (const char* const name : {"cornell_open", "cornell_open_45", "cornell_closed", "cornell_open_one",
                                   "cornell_open_five", "cornell_closed_five", "many_lights", "small_light"}) {
        for (const char* const integrator : {"depth_first", "packet", "wavefront"}) {
            for (const char* const direct_light : {"nee", "nee_mis"}) {
                Variant variant = Registry::instance().baseline();
                variant.set("integrator", integrator);
                variant.set("direct_light", direct_light);
                const KernelChoice kernel = choose_kernel(shipped(name), variant);
                EXPECT_FALSE(is_superset(kernel.compiled, all_features))
                    << name << " by " << variant.spelled_out() << " needs " << names_of(kernel.needed);
            }
        }
    }
}

// And with the ways to draw a point on a lamp that cost least.
TEST(ShippedScenes, OfTheBoxesHaveKernelsThatDrawPointsOnLamps) {
    const std::pair<const char*, Feature> ways[] = {{"projected", Feature::projected_sampling},
                                                    {"auto", Feature::automatic_sampling}};
    for (const char* const name : {"cornell_open", "cornell_open_45", "cornell_closed", "cornell_open_one",
                                   "cornell_open_five", "cornell_closed_five", "many_lights", "small_light"}) {
        for (const char* const integrator : {"depth_first", "packet", "wavefront"}) {
            for (const auto& [way, feature] : ways) {
                Variant variant = Registry::instance().baseline();
                variant.set("integrator", integrator);
                variant.set("direct_light", "nee_mis");
                variant.set("light_sampling", way);
                const KernelChoice kernel = choose_kernel(shipped(name), variant);
                EXPECT_EQ(kernel.compiled & light_samplings, no_features | feature)
                    << name << " by " << variant.spelled_out() << " needs " << names_of(kernel.needed);
            }
        }
    }
}

// And, of the scene with many lamps, that choose among them: beside `off`, which has its own, a kernel with everything
// would be what the choice is charged with.
TEST(ShippedScenes, OfManyLampsHaveKernelsThatChooseAmongThem) {
    const Scene scene = shipped("many_lights");
    for (const char* const integrator : {"depth_first", "wavefront"}) {
        for (const char* const selection : {"uniform", "power", "light_tree"}) {
            Variant variant = Registry::instance().baseline();
            variant.set("integrator", integrator);
            variant.set("direct_light", "nee_mis");
            variant.set("light_sampling", "auto");
            variant.set("light_selection", selection);
            const KernelChoice kernel = choose_kernel(scene, variant);
            EXPECT_EQ(kernel.compiled, kernel.needed) << variant.spelled_out() << " needs " << names_of(kernel.needed);
        }
    }
}

// Numbers of a figure are those in its scene's name.
TEST(ShippedScenes, DepthOfFieldBallsStandWhereTheFiguresSay) {
    const std::vector<double> depths{7.6, 8.7, 10, 12.6, 15};
    const struct {
        std::string name;
        double aperture, focus;
    } figures[] = {{"dof_focus_7_6", 1, 7.6}, {"dof_focus_8_7", 1, 8.7},     {"dof_focus_12_6", 1, 12.6},
                   {"dof_focus_15", 1, 15},   {"dof_aperture_0_5", 0.5, 10}, {"dof_aperture_1", 1, 10},
                   {"dof_aperture_2", 2, 10}};
    for (const auto& figure : figures) {
        const Scene scene = shipped(figure.name);
        EXPECT_EQ(scene.camera.aperture_radius, figure.aperture) << figure.name;
        EXPECT_EQ(scene.camera.focus_distance, figure.focus) << figure.name;
        const Vec3d forward = normalize(scene.camera.look_at - scene.camera.eye);
        std::vector<double> found;
        for (const SceneObject& object : scene.objects) {
            if (object.shape == Shape::sphere) {
                found.push_back(dot(object.translate - scene.camera.eye, forward));
            }
        }
        ASSERT_EQ(found.size(), depths.size()) << figure.name;
        std::sort(found.begin(), found.end());
        for (std::size_t i = 0; i < depths.size(); ++i) {
            EXPECT_NEAR(found[i], depths[i], 1e-6) << figure.name;
        }
    }
}

// The two scenes of a pair show one thing: everything else is equal.
TEST(ShippedScenes, PairsDifferOnlyInWhatTheyShow) {
    const auto image = [](Scene scene) {
        scene.camera.width = scene.camera.height = 16;
        RenderRequest request{.variant = Registry::instance().baseline(), .settings = default_settings(scene)};
        return render(scene, request).film.hash();
    };
    for (const std::string name : {"cornell_open", "cornell_closed"}) {
        Scene unjittered = shipped(name + "_unjittered");
        EXPECT_FALSE(unjittered.camera.jitter);
        unjittered.camera.jitter = true;
        EXPECT_EQ(image(unjittered), image(shipped(name)));
    }
    Scene jitter = shipped("jitter_off");
    EXPECT_FALSE(jitter.camera.jitter);
    jitter.camera.jitter = true;
    EXPECT_EQ(image(jitter), image(shipped("jitter_on")));

    Scene motion = shipped("motion_on");
    EXPECT_TRUE(motion.camera.shutter_late);
    EXPECT_EQ(motion.camera.shutter_close, 1);
    motion.camera.shutter_close = 0;
    EXPECT_EQ(image(motion), image(shipped("motion_off")));

    for (const std::string name : {"subsurface_ball", "subsurface_box"}) {
        Scene on = shipped(name + "_on");
        const Scene off = shipped(name + "_off");
        ASSERT_EQ(on.materials.size(), off.materials.size());
        for (std::size_t i = 0; i < on.materials.size(); ++i) {
            if (on.materials[i].type == MaterialType::subsurface) {
                EXPECT_EQ(off.materials[i].type, MaterialType::diffuse);
                on.materials[i] = off.materials[i];
            }
        }
        EXPECT_EQ(image(on), image(off));
    }
}

}  // namespace
}  // namespace pt
