// A stability case: a stiff or extreme problem with an exact answer. It says what is stiff, its parameters, what is
// rendered or computed, and the value that must result. A case is a few lines in a file of its family
// (stability/cases/) that registers itself; catalogue numbers (S1 to S48) are those of docs/numerics.md section 2.
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

// A parameter of a case, which a caller may set: `--case lamp --set a=0.03`.
struct Parameter {
    std::string name;
    double default_value = 0;
    double lowest = 0, highest = 0;
    std::string summary;  // one line of help on the parameter, with its unit
    bool is_whole = false;
};

// The value of every parameter of a stability case.
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

// The largest error of a correct implementation, in single and in double precision, and the reason for that size.
struct Tolerance {
    double single = 0, fp64 = 0;  // largest absolute errors, in the quantity's unit
    std::string origin;

    static Tolerance relative(double exact, double single, double fp64, std::string origin);
    double at(const PrecisionTraits& precision) const { return precision.is_double() ? fp64 : single; }
};

// How a measured value must relate to the exact one. equal: |measured - exact| <= allowed. at_most, at_least: `exact`
// is a bound that may be exceeded by `allowed`.
enum class Relation { equal, at_most, at_least };

// A number that a check measured, with the exact value.
struct Measurement {
    std::string quantity;
    double measured = 0;
    double exact = 0;
    Relation relation = Relation::equal;
    double standard_error = 0;  // standard error of `measured`; 0 for no estimate
    Tolerance tolerance;
};

// A number that is read from a render and compared with its exact value.
struct Quantity {
    std::string name;
    std::function<double(const RenderResult&)> of;
    double exact = 0;
    Tolerance tolerance;
    Relation relation = Relation::equal;
    // Whether the value is the mean over batches of samples, with a standard error. If not, every batch must give the
    // exact value, and the batch farthest from it counts.
    bool is_estimate = true;
};

// A scene to render in batches of equally many samples, each with its own seed, and the quantities to read from it.
struct Rendering {
    Json scene;  // content of the scene file
    std::uint64_t quick_paths = 1u << 16;
    std::uint64_t full_paths = 1u << 22;
    std::uint32_t batches = 16;
    std::vector<Quantity> quantities;
};

// Two renders whose films must be equal bit for bit.
struct Twins {
    std::string change;  // what differs between the two, e.g. "scene x 2^20"
    Json reference, changed;
    std::vector<std::uint32_t> parts = {};  // samples of each run if several runs render `changed`; empty: one run
    std::map<std::string, std::uint32_t> tuning = {};  // tunables for rendering `changed`; variants without are skipped
    std::uint32_t samples = 8;                         // samples per pixel of each of the two renders
};

// Parameter values at which a case is evaluated, each point as changes to the case's defaults.
using Points = std::vector<std::map<std::string, double>>;
// Make parameter points: `along` one for each value of a parameter, `table` one for each row of values of several.
Points along(const std::string& parameter, const std::vector<double>& values);
Points table(const std::vector<std::string>& parameters, const std::vector<std::vector<double>>& rows);
Points joined(const std::vector<Points>& lists);

// Settings of a direct check, which calls kernel functions without rendering.
struct DirectSetting {
    PrecisionTraits precision;
    bool is_naive = false;
    bool is_quick = false;
};

struct Case {
    std::string name;         // "lamp": plain, unique
    std::string catalogue;    // "S5", or "P1" and so on for ptbench's own cases
    std::string family = {};  // name of the case's family, set by CasesOf
    std::string title;
    std::string stiff;    // one sentence on what makes the case stiff
    std::string formula;  // formula or source of the exact value, as text
    std::vector<Parameter> parameters = {};
    // The parameter points of a full run, each as changes to the defaults. Empty: one point, the defaults.
    Points points = {};
    Points quick_points = {};  // parameter points of a quick run; empty: the first of `points`
    std::string sweep = {};    // the parameter that `points` vary, as a figure's axis; empty if none
    // Choices of estimators with which the case is run besides the baseline's, e.g. {"direct_light", {"nee"}}.
    AxisChoices estimators = {};
    // Joint choices on several axes to run the case with: {{"direct_light", "nee"}, {"light_selection", "power"}}.
    std::vector<std::map<std::string, std::string>> joint_estimators = {};
    // Whether the plainest variant is also run with every accelerator and every builder of the backend.
    bool over_accelerators = false;
    // The check of the case: exactly one of `renderings`, `twins` and `direct` is set.
    std::function<std::vector<Rendering>(const Values&)> renderings = {};
    std::function<std::vector<Twins>(const Values&)> twins = {};
    std::function<std::vector<Measurement>(const Values&, const DirectSetting&)> direct = {};
    // Whether the direct check has a result of its own for naive formulas, and for intersection in double (mixed).
    bool direct_has_naive = false;
    bool direct_has_mixed = false;
    // The feature whose absence in ptbench makes the case impossible; empty if the case can be run.
    std::string missing_feature = {};
    // Why the case is known to fail with these values and this variant, and the cure. Empty: the case must pass.
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

// The case's parameter values: its defaults with `changes`. Throws InputError for unknown or out-of-range parameters.
Values values_of(const Case& stiff_case, const std::map<std::string, double>& changes);

void register_cases(Family family, std::vector<Case> cases);
// Registers the cases of a family when a constant of this type at namespace scope in stability/cases/ is initialised.
template <Family family>
struct CasesOf {
    explicit CasesOf(std::vector<Case> cases) { register_cases(family, std::move(cases)); }
};

double mean_radiance(const RenderResult& result);              // mean radiance of a film over pixels and channels
double mean_channel(const RenderResult& result, int channel);  // mean radiance of a film in one colour channel
// A reader for Quantity::of: the channel value, among all pixels, that is farthest from `exact`.
std::function<double(const RenderResult&)> farthest_from(double exact);
// A reader for Quantity::of: the mean number of segments that paths fall short of `depth`, 0 in a closed scene.
std::function<double(const RenderResult&)> missing_segments(std::uint32_t depth);

// A quantity that is the estimated mean over all pixels and channels.
Quantity mean_is(const std::string& name, double exact, const Tolerance& tolerance);
// Quantities whose exact value every batch must give, without sampling error: a value read by `of` (`exactly`), or the
// channel value of all pixels, of which the one farthest from `exact` counts (`every_pixel_is`).
Quantity exactly(const std::string& name, std::function<double(const RenderResult&)> of, double exact,
                 const Tolerance& tolerance);
Quantity every_pixel_is(const std::string& name, double exact, const Tolerance& tolerance);

}  // namespace pt::stability
