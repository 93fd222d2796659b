#include "harness/stability/case.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/failure.h"

namespace pt::stability {

namespace {

std::vector<Case>& mutable_catalogue() {
    static std::vector<Case> cases;
    return cases;
}

std::size_t family_index(const Case& stiff_case) {
    return static_cast<std::size_t>(std::find(std::begin(families), std::end(families), stiff_case.family) -
                                    std::begin(families));
}

// A case's number in the catalogue, for sorting: by name "S12" would come before "S5".
int number_in_catalogue(const Case& stiff_case) { return std::stoi(stiff_case.catalogue.substr(1)); }

}  // namespace

Tolerance Tolerance::relative(double exact, double single, double fp64, std::string origin) {
    return {single * std::abs(exact), fp64 * std::abs(exact), std::move(origin)};
}

void register_cases(Family family, std::vector<Case> cases) {
    for (Case& stiff_case : cases) {
        stiff_case.family = families[static_cast<std::size_t>(family)];
        mutable_catalogue().push_back(std::move(stiff_case));
    }
}

const std::vector<Case>& catalogue() {
    static const std::vector<Case>& sorted = []() -> const std::vector<Case>& {
        std::vector<Case>& cases = mutable_catalogue();
        std::stable_sort(cases.begin(), cases.end(), [](const Case& a, const Case& b) {
            return std::tuple(family_index(a), number_in_catalogue(a), a.name) <
                   std::tuple(family_index(b), number_in_catalogue(b), b.name);
        });
        return cases;
    }();
    return sorted;
}

Values values_of(const Case& stiff_case, const std::map<std::string, double>& changes) {
    Values values;
    for (const Parameter& parameter : stiff_case.parameters) {
        values.set(parameter.name, parameter.default_value);
    }
    for (const auto& [name, value] : changes) {
        const auto parameter = std::find_if(stiff_case.parameters.begin(), stiff_case.parameters.end(),
                                            [&, &wanted = name](const Parameter& p) { return p.name == wanted; });
        if (parameter == stiff_case.parameters.end()) {
            std::string names;
            for (const Parameter& p : stiff_case.parameters) {
                names += (names.empty() ? "" : ", ") + p.name;
            }
            throw InputError("--set", stiff_case.name, "parameter \"" + name + "\"", names.empty() ? "none" : names);
        }
        if (!(value >= parameter->lowest && value <= parameter->highest) ||
            (parameter->is_whole && value != std::floor(value))) {
            throw InputError("--set", stiff_case.name, fmt::format("{}={:.17g}", name, value),
                             fmt::format("{}{:.6g} to {:.6g}", parameter->is_whole ? "a whole number from " : "",
                                         parameter->lowest, parameter->highest));
        }
        values.set(name, value);
    }
    return values;
}

Points along(const std::string& parameter, const std::vector<double>& values) {
    Points points;
    for (const double value : values) {
        points.push_back({{parameter, value}});
    }
    return points;
}

Points table(const std::vector<std::string>& parameters, const std::vector<std::vector<double>>& rows) {
    Points points;
    for (const std::vector<double>& row : rows) {
        std::map<std::string, double>& point = points.emplace_back();
        for (std::size_t i = 0; i < parameters.size(); ++i) {
            point[parameters[i]] = row.at(i);
        }
    }
    return points;
}

Points joined(const std::vector<Points>& lists) {
    Points points;
    for (const Points& list : lists) {
        points.insert(points.end(), list.begin(), list.end());
    }
    return points;
}

double mean_radiance(const RenderResult& result) {
    const Vec3d mean = result.film.mean();
    return (mean.x + mean.y + mean.z) / 3;
}

double mean_channel(const RenderResult& result, int channel) { return result.film.mean()[channel]; }

std::function<double(const RenderResult&)> farthest_from(double exact) {
    return [exact](const RenderResult& result) {
        double farthest = exact;
        for (std::uint32_t i = 0; i < result.film.width() * result.film.height(); ++i) {
            const Vec3d pixel = result.film.pixel(i);
            for (int k = 0; k < 3; ++k) {
                // NaN is farther than every number, and comparisons with it are false.
                const bool is_nearer = std::abs(pixel[k] - exact) <= std::abs(farthest - exact);
                farthest = is_nearer || std::isnan(farthest) ? farthest : pixel[k];
            }
        }
        return farthest;
    };
}

std::function<double(const RenderResult&)> missing_segments(std::uint32_t depth) {
    return [depth](const RenderResult& result) {
        return static_cast<double>(depth) -
               static_cast<double>(result.work.rays - result.work.connections) / static_cast<double>(result.work.paths);
    };
}

Quantity mean_is(const std::string& name, double exact, const Tolerance& tolerance) {
    return {.name = name, .of = mean_radiance, .exact = exact, .tolerance = tolerance};
}

Quantity exactly(const std::string& name, std::function<double(const RenderResult&)> of, double exact,
                 const Tolerance& tolerance) {
    return {.name = name, .of = std::move(of), .exact = exact, .tolerance = tolerance, .is_estimate = false};
}

Quantity every_pixel_is(const std::string& name, double exact, const Tolerance& tolerance) {
    return exactly(name, farthest_from(exact), exact, tolerance);
}

}  // namespace pt::stability
