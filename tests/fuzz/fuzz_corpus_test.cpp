// Every file of tests/fuzz/corpus once through its fuzz target, without libFuzzer: the starting points of the fuzzers,
// and what they have found (named for it), which must stay mended.
#include <algorithm>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "tests/support/command.h"
#include "tests/support/places.h"

// Each is LLVMFuzzerTestOneInput of one target (tests/fuzz/CMakeLists.txt).
extern "C" {
int fuzz_scene(const std::uint8_t* data, std::size_t size);
int fuzz_import_cis565(const std::uint8_t* data, std::size_t size);
int fuzz_import_course_json(const std::uint8_t* data, std::size_t size);
int fuzz_import_mitsuba(const std::uint8_t* data, std::size_t size);
int fuzz_import_gltf(const std::uint8_t* data, std::size_t size);
int fuzz_suite(const std::uint8_t* data, std::size_t size);
int fuzz_journal(const std::uint8_t* data, std::size_t size);
int fuzz_mesh_ply(const std::uint8_t* data, std::size_t size);
int fuzz_mesh_obj(const std::uint8_t* data, std::size_t size);
int fuzz_mesh_mtl(const std::uint8_t* data, std::size_t size);
int fuzz_mesh_glb(const std::uint8_t* data, std::size_t size);
int fuzz_environment_hdr(const std::uint8_t* data, std::size_t size);
}

namespace pt {
namespace {

using Target = int (*)(const std::uint8_t*, std::size_t);
const std::map<std::string, Target> targets{{"scene", fuzz_scene},
                                            {"import_cis565", fuzz_import_cis565},
                                            {"import_course_json", fuzz_import_course_json},
                                            {"import_mitsuba", fuzz_import_mitsuba},
                                            {"import_gltf", fuzz_import_gltf},
                                            {"suite", fuzz_suite},
                                            {"journal", fuzz_journal},
                                            {"mesh_ply", fuzz_mesh_ply},
                                            {"mesh_obj", fuzz_mesh_obj},
                                            {"mesh_mtl", fuzz_mesh_mtl},
                                            {"mesh_glb", fuzz_mesh_glb},
                                            {"environment_hdr", fuzz_environment_hdr}};
const std::filesystem::path corpus = std::filesystem::path(test::in_source("tests/fuzz/corpus"));

class FuzzCorpusTest : public testing::TestWithParam<std::string> {};

TEST_P(FuzzCorpusTest, NoFileIsAFinding) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(corpus / GetParam())) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    EXPECT_GE(files.size(), 2u);
    for (const std::filesystem::path& file : files) {
        const std::string text = test::content_of(file.string());
        EXPECT_NO_THROW(targets.at(GetParam())(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()))
            << file;
    }
}

std::vector<std::string> target_names() {
    std::vector<std::string> names;
    for (const auto& [name, target] : targets) {
        names.push_back(name);
    }
    return names;
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpusTest, testing::ValuesIn(target_names()),
                         [](const auto& target) { return target.param; });

}  // namespace
}  // namespace pt
