#include "harness/ranks/task.h"

#include <array>
#include <bit>
#include <map>

#include "harness/variant_json.h"

namespace pt {

Json task_of(const Scene& scene, const RenderRequest& request) {
    return {
        {"do", "render"},
        {"scene", scene.file},
        {"scene_hash", scene.hash},
        {"axes", Json(axes_json(request.variant))},
        {"tuning", std::map<std::string, std::uint32_t>(request.variant.tuning.begin(), request.variant.tuning.end())},
        {"cuda", request.backend == Backend::cuda},
        {"width", request.settings.width},
        {"height", request.settings.height},
        {"depth", request.settings.depth},
        {"seed", request.settings.seed},
        {"first_sample", request.first_sample},
        {"samples", request.samples},
        {"film_samples", request.film_samples}};
}

RenderRequest request_in(const Json& task) {
    RenderRequest request;
    for (const auto& [axis, choice] : task.at("axes").items()) {
        request.variant.set(axis, choice.get<std::string>());
    }
    for (const auto& [name, value] : task.at("tuning").items()) {
        request.variant.tuning[name] = value;
    }
    request.backend = task.at("cuda").get<bool>() ? Backend::cuda : Backend::cpu;
    request.settings.width = task.at("width");
    request.settings.height = task.at("height");
    request.settings.depth = task.at("depth");
    request.settings.seed = task.at("seed");
    request.first_sample = task.at("first_sample");
    request.samples = task.at("samples");
    request.film_samples = task.at("film_samples");
    return request;
}

namespace {

using CounterWords = std::array<std::uint64_t, sizeof(WorkCounters) / sizeof(std::uint64_t)>;

}  // namespace

Json json_of(const WorkCounters& work) { return std::bit_cast<CounterWords>(work); }

WorkCounters work_in(const Json& words) { return std::bit_cast<WorkCounters>(words.get<CounterWords>()); }

}  // namespace pt
