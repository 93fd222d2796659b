// A stiff or extreme case with an exact answer: what is stiff about it, its parameters, what is rendered or computed,
// and what must come out, from its formula. A case is a few lines in a file of its family (stability/cases/)
// that registers itself; the catalogue's numbers (S1 to S48) are those of docs/numerics.md section 2.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "harness/bench/suite.h"
#include "harness/render/renderer.h"
#include "harness/stability/scene_text.h"

namespace pt::stability {

// A number that a caller may set: `--case lamp --set a=0.03`.
struct Parameter {
    std::string name;
    double default_value = 0;
    double lowest = 0, highest = 0;
    std::string summary;  // one line, with the unit
    bool is_whole = false;
};

// A value for every parameter of a case.
class Values {
public:
    double operator[](const std::string& name) const { return values_.at(name); }
    std::uint32_t whole(const std::string& name) const { return static_cast<std::uint32_t>(values_.at(name)); }
    bool is_set(const std::string& name) const { return values_.at(name) != 0; }
    void set(const std::string& name, double value) { values_[name] = value; }
    const std::map<std::string, double>& all() const { return values_; }
    bool operator==(const Values&) const = default;

private:
    std::map<std::string, double> values_;
};

// How far a right implementation may be from the exact value, in single and in double precision; and why so far.
struct Tolerance {
    double single = 0, fp64 = 0;  // absolute, in the quantity's unit
    std::string origin;

    static Tolerance relative(double exact, double single, double fp64, std::string origin);
    double at(const PrecisionTraits& precision) const { return precision.is_double() ? fp64 : single; }
};

// equal: |measured - exact| <= allowed. at_most, at_least: `exact` is a bound, crossed by no more than allowed.
enum class Relation { equal, at_most, at_least };

// One number that a check measured, beside the exact one.
struct Measurement {
    std::string quantity;
    double measured = 0;
    double exact = 0;
    Relation relation = Relation::equal;
    double standard_error = 0;  // of `measured`; 0: it is no estimate
    Tolerance tolerance;
};

// A number to be read off a render.
struct Quantity {
    std::string name;
    std::function<double(const RenderResult&)> of;
    double exact = 0;
    Tolerance tolerance;
    Relation relation = Relation::equal;
    // Whether it is the mean over batches of samples, with its standard error. If not, every sample must give one
    // number; the batch that is farthest from it counts.
    bool is_estimate = true;
};

// One scene to render, in batches of equally many samples with seeds of their own, and what is read off each.
struct Rendering {
    Json scene;  // the text of a scene file
    std::uint64_t quick_paths = 1u << 16;
    std::uint64_t full_paths = 1u << 22;
    std::uint32_t batches = 16;
    std::vector<Quantity> quantities;
};

// Two renders that must leave the same film, bit for bit.
struct Twins {
    std::string change;  // what differs, e.g. "scene x 2^20"
    Json reference, changed;
    std::vector<std::uint32_t> parts = {};             // the changed one's samples, in so many runs; empty: one run
    std::map<std::string, std::uint32_t> tuning = {};  // tunables of the changed one; those its variant lacks: n/a
    std::uint32_t samples = 8;                         // a pixel
};

// Values of parameters to look at, each against the case's standards.
using Points = std::vector<std::map<std::string, double>>;
// A point for each value of one parameter; for each row of values of several.
Points along(const std::string& parameter, const std::vector<double>& values);
Points table(const std::vector<std::string>& parameters, const std::vector<std::vector<double>>& rows);
Points joined(const std::vector<Points>& lists);

// What a direct check of kernel functions is to use.
struct DirectSetting {
    PrecisionTraits precision;
    bool is_naive = false;
    bool is_quick = false;
};

struct Case {
    std::string name;         // "lamp": plain, unique
    std::string catalogue;    // "S5", or "P1" and so on for our own
    std::string family = {};  // one of `families`; CasesOf sets it
    std::string title;
    std::string stiff;    // one sentence: what is stiff about it
    std::string formula;  // where the exact value comes from
    std::vector<Parameter> parameters = {};
    // The points that a run looks at: changes against the standards. Empty: the standards alone.
    Points points = {};
    Points quick_points = {};  // of a quick run; empty: the first of `points`
    std::string sweep = {};    // the parameter that `points` vary, for the figure; empty: none
    // Choices of estimators that the case is run with besides the baseline ones, e.g. {"direct_light", {"nee"}}.
    AxisChoices estimators = {};
    // Choices of several axes at once that the case is run with, e.g. {{"direct_light", "nee"}, {"light_selection",
    // "power"}}.
    std::vector<std::map<std::string, std::string>> joint_estimators = {};
    // Whether the plainest variant is also run with every accelerator and every builder of the backend.
    bool over_accelerators = false;
    // The check of a case, which is exactly one of these.
    std::function<std::vector<Rendering>(const Values&)> renderings = {};
    std::function<std::vector<Twins>(const Values&)> twins = {};
    std::function<std::vector<Measurement>(const Values&, const DirectSetting&)> direct = {};
    // Whether `direct` has something else to do with is_naive, and with intersection in double alone.
    bool direct_has_naive = false;
    bool direct_has_mixed = false;
    // Why ptbench cannot show the case at all (a feature that it lacks); empty: it can.
    std::string missing_feature = {};
    // Why a case that should pass is known not to, and what would cure it. Empty: it must pass.
    std::function<std::string(const Values&, const VariantTraits&)> known_limit = {};
};

// The families of cases, in the order of the catalogue, and their names.
enum class Family {
    cavities,
    irradiance,
    geometry,
    dielectrics,
    media,
    throughput,
    film,
    identity,
    meshes,
    lights,
    own
};
inline constexpr std::string_view families[] = {"cavities", "irradiance", "geometry", "dielectrics",
                                                "media",    "throughput", "film",     "identity",
                                                "meshes",   "lights",     "own"};

// All cases, by family and then by number in the catalogue.
const std::vector<Case>& catalogue();

// The case's values with `changes` against its standards. Throws InputError for a parameter that it has not, or a value
// beyond the parameter's range.
Values values_of(const Case& stiff_case, const std::map<std::string, double>& changes);

void register_cases(Family family, std::vector<Case> cases);
// Registers cases of a family; a namespace-scope constant in a file of cases/.
template <Family family>
struct CasesOf {
    explicit CasesOf(std::vector<Case> cases) { register_cases(family, std::move(cases)); }
};

// Readers of a render for Quantity::of.
double mean_radiance(const RenderResult& result);              // over pixels and channels
double mean_channel(const RenderResult& result, int channel);  // over pixels
// The channel value of all pixels that is farthest from `exact`.
std::function<double(const RenderResult&)> farthest_from(double exact);
// Segments that paths are short of `depth` on average: what leaked out of a closed scene without emitters.
std::function<double(const RenderResult&)> missing_segments(std::uint32_t depth);

// The mean over pixels and channels, estimated.
Quantity mean_is(const std::string& name, double exact, const Tolerance& tolerance);
// What every batch gives, without an error of estimation; and every pixel and channel of one, of which the farthest
// from `exact` counts.
Quantity exactly(const std::string& name, std::function<double(const RenderResult&)> of, double exact,
                 const Tolerance& tolerance);
Quantity every_pixel_is(const std::string& name, double exact, const Tolerance& tolerance);

}  // namespace pt::stability
