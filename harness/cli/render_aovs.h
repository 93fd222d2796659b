// What `ptbench render --aovs` writes into an .exr beside the colour (arbitrary output variables, as renderers call
// them): which there are, what they ask of the render, and the layers that they become.
#pragma once

#include <nlohmann/json.hpp>

#include "harness/exr.h"
#include "harness/render/pixel_variance.h"
#include "harness/render/renderer.h"

namespace pt {

// The names of the AOVs that a render can write: "albedo", "normal", and so on.
std::vector<std::string> names_of_aovs();
// The names of the AOVs with commas between, for messages.
std::string aov_names_text();

class RenderAovs {
public:
    // Reads the AOVs asked for, "albedo,variance" or "all"; "": none. Throws InputError for other names.
    static RenderAovs parse(const std::string& text);

    bool none() const { return names_.empty(); }
    // Throws InputError where the file's format, the variant or the number of samples cannot have these AOVs.
    void check(const std::string& file, const RenderRequest& request) const;

    // The variance that a render feeds from its checkpoints, which it makes at variance_stops; null if no AOV needs it.
    PixelVariance* variance() { return has("variance") ? &variance_ : nullptr; }

    // Makes the layers after the render, and adds to the summary what they were made from.
    std::vector<ExrLayer> layers(const Scene& scene, const RenderRequest& request, const RenderResult& result,
                                 nlohmann::ordered_json& summary) const;

private:
    bool has(std::string_view name) const;

    std::vector<std::string> names_;
    PixelVariance variance_;
};

}  // namespace pt
