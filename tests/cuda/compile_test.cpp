// Every kernel that a shipped scene can ask for compiles, for every GPU that ptbench supports. No GPU is needed: NVRTC
// compiles for any.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/bench/compile_ahead.h"
#include "harness/bench/suite.h"
#include "harness/cuda/backend.h"
#include "harness/cuda/cell.h"
#include "harness/places.h"
#include "variants/cuda/nvrtc.h"
#include "variants/cuda/sources.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

constexpr const char* architectures[] = {"sm_75", "sm_80", "sm_86", "sm_89", "sm_90", "sm_100", "sm_120"};

std::string stage_source(std::string_view axis, const std::string& choice) {
    return fmt::format("variants/{}/{}.cuh", axis, choice);
}

bool is_embedded(const std::string& name) {
    const auto sources = cuda::embedded_sources();
    return std::any_of(sources.begin(), sources.end(), [&](const auto& source) { return source.name == name; });
}

Variant with(std::initializer_list<std::pair<const char*, std::string>> choices) {
    Variant variant = Registry::instance().baseline(Backend::cuda);
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

std::vector<std::string> names_on(std::string_view axis) {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices(axis, Backend::cuda)) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

// The programs of one GPU, each once.
class Programs {
public:
    explicit Programs(std::string architecture) : architecture_(std::move(architecture)) {}

    // The integrator's program, if the variant applies to the scene.
    void add(const Scene& scene, const Variant& variant) {
        if (why_not_applicable(variant, features_of(scene), Backend::cuda).empty()) {
            add(cuda::module_request(scene, variant, architecture_), scene.name + " " + variant.name());
        }
    }
    void add_stage(const std::string& source, const Variant& variant) {
        add(cuda::stage_request(variant, source, architecture_), variant.name());
    }

    struct Program {
        cuda::ModuleRequest request;
        std::string asked_for_by;  // the first of them
    };
    const std::map<std::string, Program>& by_key() const { return programs_; }

private:
    void add(const cuda::ModuleRequest& request, const std::string& asked_for_by) {
        programs_.try_emplace(cuda::module_key(request), Program{request, asked_for_by});
    }

    std::string architecture_;
    std::map<std::string, Program> programs_;
};

const std::vector<Scene>& shipped_scenes() {
    static const std::vector<Scene> scenes = [] {
        std::vector<Scene> all;
        for (const std::string& name : scene_names()) {
            all.push_back(find_scene(name));
        }
        return all;
    }();
    return scenes;
}

TEST(Count, It) {
    ::setenv("PTBENCH_HOME", PTBENCH_SOURCE_DIR, 1);
    {
        Programs p("sm_90");
        for (const Scene& s : shipped_scenes()) {
            const std::size_t before = p.by_key().size();
            for (const auto& i : names_on("integrator")) {
                p.add(s, with({{"integrator", i}}));
            }
            std::printf("%s %zu\n", s.name.c_str(), p.by_key().size() - before);
        }
        std::printf("off: %zu\n", p.by_key().size());
        for (const Scene& s : shipped_scenes()) {
            for (const auto& i : names_on("integrator")) {
                p.add(s, with({{"integrator", i}, {"direct_light", "final_bounce"}}));
            }
        }
        std::printf("+final: %zu\n", p.by_key().size());
    }
}

}  // namespace
}  // namespace pt
