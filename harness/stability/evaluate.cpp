#include "harness/stability/evaluate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

namespace pt::stability {

namespace {

// Values of a quantity in each batch, with their mean and standard error.
struct Estimate {
    std::vector<double> values;

    double mean() const {
        double sum = 0;
        for (const double value : values) {
            sum += value;
        }
        return sum / static_cast<double>(values.size());
    }
    double standard_error() const {
        const double average = mean();
        double squares = 0;
        for (const double value : values) {
            squares += (value - average) * (value - average);
        }
        const auto n = static_cast<double>(values.size());
        return n > 1 ? std::sqrt(squares / (n * (n - 1))) : 0;
    }
    double farthest(double exact) const {
        double result = exact;
        for (const double value : values) {
            result = std::abs(value - exact) <= std::abs(result - exact) ? result : value;
        }
        return result;
    }
};

Row without_measurement(Status status, std::string reason) {
    Row row;
    row.status = status;
    row.reason = std::move(reason);
    return row;
}

// Adds the paths, rays, film faults and time of a render to the totals of a result row.
void count_work(Row& row, const RenderResult& result) {
    row.paths += result.work.paths;
    row.rays += result.work.rays;
    row.unfinished_walks += result.work.unfinished_walks;
    row.faults += result.film.faults();
    row.health.add(result.health);
    row.seconds += 1e-3 * result.wall_ms;
}

double missed_by(const Measurement& m) {
    const double difference = m.measured - m.exact;
    const double missed = m.relation == Relation::at_most    ? std::max(difference, 0.0)
                          : m.relation == Relation::at_least ? std::max(-difference, 0.0)
                                                             : std::abs(difference);
    return std::isnan(difference) ? std::numeric_limits<double>::infinity() : missed;
}

void judge(Row& row, const Task& task) {
    row.error = missed_by(row.measurement);
    row.allowed = row.measurement.tolerance.at(traits_of(task.variant, task.backend).precision) +
                  4 * row.measurement.standard_error;
    if (!row.faults.none()) {
        row.status = Status::broken;
        row.reason = faults_text(row.faults);
    } else {
        row.status = row.error <= row.allowed ? Status::passed : Status::failed;
    }
    if (row.status != Status::passed && must_pass(task.variant, task.backend) && task.stiff_case->known_limit) {
        const std::string limit = task.stiff_case->known_limit(task.values, traits_of(task.variant, task.backend));
        if (!limit.empty()) {
            row.status = Status::known_limit;
            row.reason = limit;
        }
    }
}

Scene scene_of(const Json& text, const Case& stiff_case) {
    return parse_scene(text.dump(), "stability case " + stiff_case.name);
}

RenderRequest request_of(const Task& task, const Scene& scene, std::uint64_t seed, std::uint32_t samples) {
    RenderRequest request{
        .variant = task.variant, .backend = task.backend, .settings = default_settings(scene), .samples = samples};
    request.settings.seed = seed;
    return request;
}

// Sets as many samples per pixel in flight as the integrator takes, since a case's image has few pixels and many
// samples, and a GPU would otherwise run few threads.
Variant with_samples_in_flight(const Task& task, Variant variant, std::uint64_t pixels, std::uint64_t samples) {
    for (const Tunable& tunable : tunables_of(variant, task.backend)) {
        if (tunable.name == "spp_in_flight" && !variant.tuning.contains("spp_in_flight")) {
            const std::uint64_t wanted = std::min(samples, std::max<std::uint64_t>(1, (1u << 18) / pixels));
            variant.tuning["spp_in_flight"] =
                static_cast<std::uint32_t>(std::clamp<std::uint64_t>(wanted, tunable.lowest, tunable.highest));
        }
    }
    return variant;
}

// Limits a case's number of samples for an integrator with a queue, whose time grows with each pass through the queue
// (one for each group of samples in flight), even if it holds few paths.
std::uint64_t affordable_samples(const Task& task, const Variant& variant, std::uint32_t depth, std::uint64_t samples) {
    const std::uint64_t most_rounds = std::max(1u, 512 / depth);
    const auto in_flight = variant.tuning.find("spp_in_flight");
    const std::uint64_t at_once = in_flight != variant.tuning.end() ? in_flight->second : 1;
    const bool has_queue = traits_of(task.variant, task.backend).integrator.has_queue;
    return has_queue ? std::min(samples, most_rounds * at_once) : samples;
}

double differing_pixels(const std::vector<std::int64_t>& a, const std::vector<std::int64_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i + 2 < a.size(); i += 3) {
        count += a[i] != b[i] || a[i + 1] != b[i + 1] || a[i + 2] != b[i + 2] ? 1u : 0u;
    }
    return static_cast<double>(count);
}

// The variant's bitwise reference with every feature compiled in: cases have hundreds of scenes with different
// features, and a kernel with all features is compiled only once.
Variant bitwise_reference(const Task& task) {
    return with_every_feature(Registry::instance().reference(task.variant, task.backend), task.backend);
}

// Compares the film with the reference integrator's bit for bit, where an integrator with a queue can afford only a
// part of the samples of a case: equal bits say more than an estimate from so few samples. Returns nothing where all
// samples are affordable or the arithmetic is relaxed.
std::optional<Row> compared_with_reference(const Task& task, const Scene& scene, std::uint64_t paths) {
    const std::uint64_t pixels = std::uint64_t{scene.camera.width} * scene.camera.height;
    const std::uint64_t wanted = std::max<std::uint64_t>(1, paths / pixels);
    const Variant variant = with_samples_in_flight(task, task.variant, pixels, wanted);
    const std::uint64_t samples = affordable_samples(task, variant, scene.max_depth, wanted);
    if (samples == wanted || fp_relaxed(task.variant, task.backend)) {
        return std::nullopt;
    }
    Row row;
    RenderRequest request = request_of(task, scene, task.seed, static_cast<std::uint32_t>(samples));
    request.variant = variant;
    const RenderResult result = render_named(scene, request);
    request.variant = with_samples_in_flight(task, bitwise_reference(task), pixels, samples);
    const RenderResult reference = render_named(scene, request);
    count_work(row, result);
    row.film_hash = result.film.hash();
    row.seconds += 1e-3 * reference.wall_ms;
    row.measurement.quantity = "pixels that differ from " + request.variant[axes::integrator] + " in fewer samples";
    row.measurement.measured = differing_pixels(result.film.sums(), reference.film.sums());
    row.measurement.tolerance.origin = "bit for bit";
    judge(row, task);
    return row;
}

// Measures every quantity of a stability rendering once, with about `paths` paths.
std::vector<Row> look(const Task& task, const Rendering& rendering, const Scene& scene, std::uint64_t seed,
                      std::uint64_t paths) {
    const bool estimates = std::any_of(rendering.quantities.begin(), rendering.quantities.end(),
                                       [](const Quantity& quantity) { return quantity.is_estimate; });
    const std::uint64_t batches = estimates ? rendering.batches : 1;
    const std::uint64_t pixels = std::uint64_t{scene.camera.width} * scene.camera.height;
    const std::uint64_t wanted = std::max<std::uint64_t>(1, paths / (pixels * batches));
    const Variant variant = with_samples_in_flight(task, task.variant, pixels, wanted);
    const auto samples = static_cast<std::uint32_t>(
        std::max<std::uint64_t>(1, affordable_samples(task, variant, scene.max_depth, batches * wanted) / batches));
    Row common;
    std::vector<Estimate> estimate(rendering.quantities.size());
    for (std::uint64_t batch = 0; batch < batches; ++batch) {
        RenderRequest request = request_of(task, scene, seed + batch, samples);
        request.variant = variant;
        const RenderResult result = render_named(scene, request);
        count_work(common, result);
        common.film_hash = batches == 1 ? result.film.hash() : "";
        for (std::size_t i = 0; i < estimate.size(); ++i) {
            estimate[i].values.push_back(rendering.quantities[i].of(result));
        }
    }
    std::vector<Row> rows;
    for (std::size_t i = 0; i < estimate.size(); ++i) {
        const Quantity& quantity = rendering.quantities[i];
        Row row = common;
        row.is_estimate = quantity.is_estimate;
        row.measurement = {
            .quantity = quantity.name,
            .measured = quantity.is_estimate ? estimate[i].mean() : estimate[i].farthest(quantity.exact),
            .exact = quantity.exact,
            .relation = quantity.relation,
            .standard_error = quantity.is_estimate ? estimate[i].standard_error() : 0,
            .tolerance = quantity.tolerance,
        };
        judge(row, task);
        rows.push_back(std::move(row));
    }
    return rows;
}

std::vector<Row> evaluate_renderings(const Task& task) {
    std::vector<Row> rows;
    for (const Rendering& rendering : task.stiff_case->renderings(task.values)) {
        const Scene scene = scene_of(rendering.scene, *task.stiff_case);
        if (std::string reason = why_not_applicable(task.variant, features_of(scene), task.backend); !reason.empty()) {
            rows.push_back(without_measurement(Status::not_applicable, std::move(reason)));
            continue;
        }
        const std::uint64_t paths = task.paths != 0 ? task.paths
                                    : task.is_quick ? rendering.quick_paths
                                                    : rendering.full_paths;
        if (std::optional<Row> row = compared_with_reference(task, scene, paths)) {
            rows.push_back(std::move(*row));
            continue;
        }
        std::vector<Row> first = look(task, rendering, scene, task.seed, paths);
        const bool again = std::any_of(first.begin(), first.end(),
                                       [](const Row& row) { return row.status == Status::failed && row.is_estimate; });
        if (again) {
            // An estimate that failed its check is measured once more, with four times the samples and other seeds.
            std::vector<Row> second =
                look(task, rendering, scene, task.seed + 1000003, std::min<std::uint64_t>(4 * paths, 1u << 28));
            for (std::size_t i = 0; i < first.size(); ++i) {
                if (first[i].status == Status::failed && first[i].is_estimate) {
                    second[i].looks = 2;
                    second[i].seconds += first[i].seconds;
                    first[i] = std::move(second[i]);
                }
            }
        }
        std::move(first.begin(), first.end(), std::back_inserter(rows));
    }
    return rows;
}

// Renders a scene in parts of the given numbers of samples and adds up the films' sums.
std::vector<std::int64_t> sums_in_parts(const Task& task, const Scene& scene, std::vector<std::uint32_t> parts,
                                        std::uint32_t all_samples, Row& row) {
    if (parts.empty()) {
        parts.push_back(all_samples);
    }
    std::vector<std::int64_t> sums;
    std::uint32_t done = 0;
    for (const std::uint32_t samples : parts) {
        RenderRequest request = request_of(task, scene, task.seed, samples);
        request.first_sample = done;
        request.film_samples = all_samples;
        const RenderResult result = render_named(scene, request);
        done += samples;
        count_work(row, result);
        sums.resize(result.film.sums().size());
        for (std::size_t i = 0; i < sums.size(); ++i) {
            sums[i] += result.film.sums()[i];
        }
    }
    return sums;
}

// Whether the same program renders both scenes: the generic kernel, or one for the same features and object counts.
bool have_one_program(const Task& task, const Scene& a, const Scene& b) {
    return traits_of(task.variant, task.backend).specialisation.is_generic ||
           (choose_kernel(a, task.variant, task.backend).compiled ==
                choose_kernel(b, task.variant, task.backend).compiled &&
            a.objects.size() == b.objects.size());
}

// Measures the ratio of the means of two films that may differ in rounding and by a few paths that graze an edge. Its
// standard error assumes that differences of pixels and channels are independent.
Measurement ratio_of_means(const std::vector<std::int64_t>& expected, const std::vector<std::int64_t>& found) {
    double sum = 0, difference = 0, squares = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto d = static_cast<double>(found[i] - expected[i]);
        sum += static_cast<double>(expected[i]);
        difference += d;
        squares += d * d;
    }
    return {.quantity = "mean over mean",
            .measured = 1 + difference / sum,
            .exact = 1,
            .standard_error = std::sqrt(squares) / sum,
            .tolerance = {1e-6, 1e-12, "programs of one formula that round apart"}};
}

Row evaluate_pair(const Task& task, const Twins& twins) {
    const Scene reference = scene_of(twins.reference, *task.stiff_case);
    const Scene changed = scene_of(twins.changed, *task.stiff_case);
    Row row;
    row.measurement.quantity = "pixels that differ: " + twins.change;
    row.measurement.tolerance.origin = "bit for bit";
    Task tuned = task;
    const std::vector<Tunable> known = tunables_of(task.variant, task.backend);
    for (const auto& [name, value] : twins.tuning) {
        const bool has_it = std::any_of(known.begin(), known.end(),
                                        [&, &wanted = name](const Tunable& tunable) { return tunable.name == wanted; });
        if (!has_it) {
            row.reason = "the variant has no tunable " + name;
            return row;
        }
        tuned.variant.tuning[name] = value;
    }
    for (const Scene* scene : {&reference, &changed}) {
        row.reason = why_not_applicable(tuned.variant, features_of(*scene), task.backend);
        if (!row.reason.empty()) {
            return row;
        }
    }
    const std::vector<std::int64_t> expected = sums_in_parts(task, reference, {}, twins.samples, row);
    const std::vector<std::int64_t> found = sums_in_parts(tuned, changed, twins.parts, twins.samples, row);
    if (fp_relaxed(task.variant, task.backend) && !have_one_program(tuned, reference, changed)) {
        row.measurement = ratio_of_means(expected, found);
        row.measurement.quantity += ": " + twins.change;
    } else {
        row.measurement.measured = differing_pixels(expected, found);
    }
    judge(row, task);
    return row;
}

std::vector<Row> evaluate_direct(const Task& task) {
    const VariantTraits traits = traits_of(task.variant, task.backend);
    const DirectSetting setting{
        .precision = traits.precision, .is_naive = traits.robustness.is_naive, .is_quick = task.is_quick};
    const auto start = std::chrono::steady_clock::now();
    std::vector<Row> rows;
    for (Measurement& measurement : task.stiff_case->direct(task.values, setting)) {
        Row row;
        row.measurement = std::move(measurement);
        judge(row, task);
        rows.push_back(std::move(row));
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (Row& row : rows) {
        row.seconds = seconds;
    }
    return rows;
}

std::vector<Row> evaluate_unguarded(const Task& task) {
    if (task.stiff_case->renderings) {
        return evaluate_renderings(task);
    }
    if (task.stiff_case->direct) {
        return evaluate_direct(task);
    }
    std::vector<Row> rows;
    for (const Twins& twins : task.stiff_case->twins(task.values)) {
        rows.push_back(evaluate_pair(task, twins));
    }
    return rows;
}

// Says why a direct check does not apply to a task. It calls functions on the host, so one integrator will do.
std::string direct_not_applicable(const Task& task) {
    const VariantTraits traits = traits_of(task.variant, task.backend);
    const bool is_plainest = task.variant[axes::integrator] == plainest_variant(task.backend)[axes::integrator];
    if (!is_plainest || fp_relaxed(task.variant, task.backend)) {
        return "checks functions, not images: on the host, once";
    }
    if (traits.robustness.is_naive && !task.stiff_case->direct_has_naive) {
        return "has no naive twin of what it checks";
    }
    if (traits.precision.is_mixed() && !task.stiff_case->direct_has_mixed) {
        return "has no intersection in it";
    }
    return "";
}

}  // namespace

Variant plainest_variant(Backend backend) {
    const Registry& registry = Registry::instance();
    Variant variant = with_every_feature(registry.reference(registry.baseline(backend), backend), backend);
    variant.set(axes::arithmetic, "exact");
    return variant;
}

std::string_view to_string(Status status) {
    switch (status) {
        case Status::passed:
            return "passed";
        case Status::failed:
            return "failed";
        case Status::known_limit:
            return "known limit";
        case Status::not_applicable:
            return "n/a";
        default:
            return "broken";
    }
}

bool must_pass(const Variant& variant, Backend backend) {
    const VariantTraits traits = traits_of(variant, backend);
    const Choice* accelerator = Registry::instance().find(axes::accelerator, variant[axes::accelerator], backend);
    const bool is_our_test = accelerator == nullptr || accelerator->descriptor.claim == Claim::bitwise;
    return !traits.robustness.is_naive && !traits.arithmetic.is_approximate && is_our_test;
}

std::vector<std::pair<std::string, Variant>> renders_of(const Task& task) {
    std::vector<std::pair<std::string, Variant>> renders;
    const Case& stiff_case = *task.stiff_case;
    if (!not_applicable(task).empty() || stiff_case.direct) {
        return renders;
    }
    if (stiff_case.renderings) {
        const bool has_queue = traits_of(task.variant, task.backend).integrator.has_queue;
        for (const Rendering& rendering : stiff_case.renderings(task.values)) {
            renders.emplace_back(rendering.scene.dump(), task.variant);
            if (has_queue && !fp_relaxed(task.variant, task.backend)) {
                renders.emplace_back(rendering.scene.dump(), bitwise_reference(task));
            }
        }
        return renders;
    }
    for (const Twins& twins : stiff_case.twins(task.values)) {
        Variant tuned = task.variant;
        for (const auto& [name, value] : twins.tuning) {
            tuned.tuning[name] = value;
        }
        renders.emplace_back(twins.reference.dump(), task.variant);
        renders.emplace_back(twins.changed.dump(), without_foreign_tunables(tuned, task.backend));
    }
    return renders;
}

std::string not_applicable(const Task& task) {
    if (!task.stiff_case->missing_feature.empty()) {
        return task.stiff_case->missing_feature;
    }
    return task.stiff_case->direct ? direct_not_applicable(task) : "";
}

std::vector<Row> evaluate(const Task& task) {
    if (std::string reason = not_applicable(task); !reason.empty()) {
        return {without_measurement(Status::not_applicable, std::move(reason))};
    }
    try {
        return evaluate_unguarded(task);
    } catch (const std::exception& exception) {
        return {without_measurement(Status::broken, exception.what())};
    }
}

}  // namespace pt::stability
