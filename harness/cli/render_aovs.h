// Arbitrary output variables (AOVs) that `ptbench render --aovs` writes into an .exr file beside the colour.
#pragma once

#include <nlohmann/json.hpp>

#include "harness/exr.h"
#include "harness/render/pixel_variance.h"
#include "harness/render/renderer.h"

namespace pt {

// The names of the AOVs that a render can write: "albedo", "normal", and so on.
std::vector<std::string> names_of_aovs();
// The names of the AOVs, joined by commas, for messages.
std::string aov_names_text();

class RenderAovs {
public:
    // Parses a list of AOVs, "albedo,variance" or "all"; "" means none. Throws InputError for other names.
    static RenderAovs parse(const std::string& text);

    bool none() const { return names_.empty(); }
    // Throws InputError if the file format, the variant or the number of samples does not support these AOVs.
    void check(const std::string& file, const RenderRequest& request) const;

    // The variance estimator, to be fed at variance_stops of the render; null if no AOV needs it.
    PixelVariance* variance() { return has("variance") ? &variance_ : nullptr; }

    // Makes the layers of the .exr file after the render, and adds to the summary what they were computed from.
    std::vector<ExrLayer> layers(const Scene& scene, const RenderRequest& request, const RenderResult& result,
                                 nlohmann::ordered_json& summary) const;

private:
    bool has(std::string_view name) const;

    std::vector<std::string> names_;
    PixelVariance variance_;
};

}  // namespace pt
