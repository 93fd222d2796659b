// Scenes in the seeds' text format: what the importer accepts is a scene file.
#include "harness/scene/import_seed.h"

#include "tests/fuzz/findings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::accept_or_refuse([&] {
        const std::string scene = pt::import_seed_scene(pt::fuzz::text_of(data, size), "seed.txt");
        try {
            (void)pt::parse_scene(scene, "scene.json");
        } catch (const pt::InputError& error) {
            throw std::logic_error(std::string("imported, but no scene: ") + error.what());
        }
    });
    return 0;
}
