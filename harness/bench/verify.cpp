#include "harness/bench/verify.h"

#include "harness/bench/imprint.h"
#include "harness/bench/suite.h"
#include "harness/render/renderer.h"
#include "variants/variant_name.h"

#include <cmath>

#include <fmt/format.h>

namespace pt {

namespace {

RenderResult render_samples(const Scene& scene, const RenderSettings& settings, const Variant& variant, Backend backend,
                            std::uint32_t first, std::uint32_t count, std::uint32_t film_samples) {
    return render_named(scene, {.variant = variant,
                                .backend = backend,
                                .settings = settings,
                                .first_sample = first,
                                .samples = count,
                                .film_samples = film_samples});
}

// Faults that a render can show without a comparison: bad film values, missing work, a wrong path count; empty if none.
std::string fault_of(const RenderResult& result, const Variant& variant, Backend backend,
                     const RenderSettings& settings, std::uint32_t spp) {
    if (const FilmFaults& faults = result.film.faults(); !faults.none()) {
        return faults_text(faults);
    }
    if (const std::string missing = check_counters(variant, result.work, spp, backend); !missing.empty()) {
        return missing;
    }
    if (result.work.paths != std::uint64_t{settings.width} * settings.height * spp) {
        return fmt::format("{} paths for {} pixels of {} samples", result.work.paths, settings.width * settings.height,
                           spp);
    }
    return "";
}

bool same_pixel(const Film& a, const Film& b, std::size_t pixel) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
        if (a.sums()[3 * pixel + channel] != b.sums()[3 * pixel + channel]) {
            return false;
        }
    }
    return true;
}

// A film's channel means over each block of 16x16 pixels, then over the whole image.
std::vector<double> block_means(const Film& film) {
    const std::uint32_t columns = (film.width() + 15) / 16;
    const std::uint32_t rows = (film.height() + 15) / 16;
    std::vector<double> sums(std::size_t{3} * columns * rows + 3);
    std::vector<double> counts(sums.size());
    for (std::uint32_t pixel = 0; pixel < film.width() * film.height(); ++pixel) {
        const std::size_t block = (pixel / film.width() / 16) * columns + pixel % film.width() / 16;
        const Vec3d radiance = film.pixel(pixel);
        for (int channel = 0; channel < 3; ++channel) {
            sums[3 * block + static_cast<std::size_t>(channel)] += radiance[channel];
            counts[3 * block + static_cast<std::size_t>(channel)] += 1;
            sums[sums.size() - 3 + static_cast<std::size_t>(channel)] += radiance[channel];
            counts[sums.size() - 3 + static_cast<std::size_t>(channel)] += 1;
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i] /= counts[i];
    }
    return sums;
}

constexpr int batches = 24;
constexpr double failing_t = 7;

// The block means of several independent renders with the seeds 1000, 1001, ...
std::vector<std::vector<double>> batch_means(const Scene& scene, RenderSettings settings, const Variant& variant,
                                             Backend backend, std::uint32_t spp) {
    std::vector<std::vector<double>> means;
    for (int batch = 0; batch < batches; ++batch) {
        settings.seed = 1000 + static_cast<std::uint64_t>(batch);
        means.push_back(block_means(render_samples(scene, settings, variant, backend, 0, spp, spp).film));
    }
    return means;
}

struct PairedDifference {
    double mean_a = 0, mean_b = 0;
    double difference = 0;  // mean over batches of the difference between variant a and variant b
    double error = 0;       // standard error of the mean difference between the two variants
};

PairedDifference paired_difference(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b,
                                   std::size_t entry) {
    PairedDifference result;
    double squares = 0;
    for (std::size_t batch = 0; batch < a.size(); ++batch) {
        const double difference = a[batch][entry] - b[batch][entry];
        const double delta = difference - result.difference;  // Welford's online mean and variance
        const auto count = static_cast<double>(batch + 1);
        result.difference += delta / count;
        squares += delta * (difference - result.difference);
        result.mean_a += (a[batch][entry] - result.mean_a) / count;
        result.mean_b += (b[batch][entry] - result.mean_b) / count;
    }
    const auto count = static_cast<double>(a.size());
    result.error = std::sqrt(squares / (count - 1) / count);
    return result;
}

}  // namespace

std::string Difference::text() const {
    return fmt::format("first at pixel {},{}, {}{}", x, y,
                       sample ? fmt::format("sample {}", *sample) : std::string("in how its samples are put together"),
                       bounce ? fmt::format(", bounce {}", *bounce) : "");
}

Difference first_difference(const Scene& scene, const RenderSettings& settings, std::uint32_t spp,
                            const Variant& reference, const Variant& variant, Backend backend) {
    const auto differs = [&](const RenderSettings& s, std::uint32_t first, std::uint32_t count, std::size_t pixel) {
        return !same_pixel(render_samples(scene, s, reference, backend, first, count, spp).film,
                           render_samples(scene, s, variant, backend, first, count, spp).film, pixel);
    };
    const Film a = render_samples(scene, settings, reference, backend, 0, spp, spp).film;
    const Film b = render_samples(scene, settings, variant, backend, 0, spp, spp).film;
    std::size_t pixel = 0;
    while (pixel + 1 < std::size_t{settings.width} * settings.height && same_pixel(a, b, pixel)) {
        ++pixel;
    }
    Difference difference{
        static_cast<std::uint32_t>(pixel % settings.width), static_cast<std::uint32_t>(pixel / settings.width), {}, {}};
    for (std::uint32_t sample = 0; sample < spp && !difference.sample; ++sample) {
        if (differs(settings, sample, 1, pixel)) {
            difference.sample = sample;
        }
    }
    for (std::uint32_t depth = 1; depth <= settings.depth && difference.sample && !difference.bounce; ++depth) {
        RenderSettings shorter = settings;
        shorter.depth = depth;
        if (differs(shorter, *difference.sample, 1, pixel)) {
            difference.bounce = depth;
        }
    }
    return difference;
}

const RenderResult& Verifier::reference(const Variant& reference_variant) {
    const auto known = references_.find(reference_variant);
    if (known != references_.end()) {
        return known->second;
    }
    return references_.emplace(reference_variant, render_part(reference_variant, 0, spp_)).first->second;
}

RenderResult Verifier::render_part(const Variant& variant, std::uint32_t first, std::uint32_t count) const {
    return render_samples(scene_, settings_, variant, backend_, first, count, spp_);
}

// The CPU's reference variant rounds as CUDA's does, so films should be equal bit for bit. One sample in 1e5 may take
// another path (docs/numerics.md 4): every pixel that differs counts as one sample.
const Verifier::CpuCheck& Verifier::against_cpu(const Variant& reference_variant) {
    const auto known = against_cpu_.find(reference_variant);
    if (known != against_cpu_.end()) {
        return known->second;
    }
    CpuCheck& check = against_cpu_[reference_variant];
    Variant plain = reference_variant;
    for (const std::string_view axis : {axes::integrator, axes::layout, axes::launch}) {
        plain.set(axis, expand({}, Backend::cpu).front()[axis]);
    }
    for (const std::string_view axis : axis_names) {
        if (Registry::instance().find(axis, plain[axis], Backend::cpu) == nullptr) {
            return check;  // the CPU backend lacks one of the variant's choices
        }
    }
    plain = fast_reference_on(scene_, plain, Backend::cpu);
    if (!why_not_applicable(plain, features_of(scene_), Backend::cpu).empty()) {
        return check;  // the CPU backend has no counterpart of the variant: matrices in double precision
    }
    check.is_made = true;
    const RenderResult expected = render_samples(scene_, settings_, plain, Backend::cpu, 0, spp_, spp_);
    const Film& film = reference(reference_variant).film;
    std::size_t differing = 0;
    for (std::size_t pixel = 0; pixel < std::size_t{settings_.width} * settings_.height; ++pixel) {
        differing += same_pixel(film, expected.film, pixel) ? 0u : 1u;
    }
    const double paths = static_cast<double>(settings_.width) * settings_.height * spp_;
    if (static_cast<double>(differing) > 1e-5 * paths) {
        check.failure =
            fmt::format("the film of {} differs from the CPU's in {} pixels of {:.0f} paths (allowed: 1e-5)",
                        shown_name(reference_variant, backend_), differing, paths);
    }
    return check;
}

// Paired t-test of the image mean and the 16x16-block means, between `variant` and the variant whose expectation it
// claims (Descriptor::mean_of), over 24 batches. Both sides have the same seeds and random numbers are keyed by their
// purpose, so only what the two do differently contributes to the spread. With 23 degrees of freedom, |t| > 7 has a
// false-alarm probability of 4e-7 for a statistic, 1e-4 for 64 blocks. Fixed seeds make the verdict reproducible.
Verifier::MeanCheck Verifier::check_statistical(const Variant& variant) {
    const Variant plain = variant_of_mean(variant, backend_);
    RenderSettings deeper = settings_;
    std::string plain_text;
    for (const std::string_view axis : axis_names) {
        const Descriptor& descriptor = Registry::instance().at(axis, variant, backend_).descriptor;
        if (descriptor.claim == Claim::statistical) {
            deeper.depth += descriptor.mean_at_extra_depth;
            plain_text += fmt::format("{}={} ", axis, descriptor.mean_of);
        }
    }
    const std::uint32_t spp = std::max(4u, spp_);
    const auto claimed = batch_means(scene_, settings_, variant, backend_, spp);
    const auto expected = batch_means(scene_, deeper, plain, backend_, spp);
    // `without` shows how much the choices change the mean: `plain`, the variant with the claimed mean, at equal depth.
    const auto without =
        deeper.depth != settings_.depth ? batch_means(scene_, settings_, plain, backend_, spp) : expected;
    MeanCheck check;
    for (std::size_t i = 0; i < claimed.front().size(); ++i) {
        const PairedDifference pair = paired_difference(claimed, expected, i);
        const bool is_image = i + 3 >= claimed.front().size();
        // Means of blocks that light rarely reaches are skewed; only those with enough contributions are nearly normal.
        const bool usable = is_image || pair.error < 0.1 * std::max(pair.mean_a, pair.mean_b);
        if (usable && std::abs(pair.difference) > failing_t * pair.error + 1e-6 * std::abs(pair.mean_b)) {
            check.failure =
                fmt::format("{}, channel {}: mean {:.6g} against {:.6g} of {}at depth {} ({:.1f} standard errors)",
                            is_image ? "image" : fmt::format("16x16 block {}", i / 3), i % 3, pair.mean_a, pair.mean_b,
                            plain_text, deeper.depth, pair.difference / pair.error);
            return check;
        }
        if (is_image && pair.mean_b > 0) {
            check.detectable = std::max(check.detectable, failing_t * pair.error / pair.mean_b);
            check.effect =
                std::max(check.effect, std::abs(paired_difference(expected, without, i).difference) / pair.mean_b);
        }
    }
    return check;
}

const Verifier::MeanCheck& Verifier::mean_check(const Variant& variant) {
    const auto [position, is_new] = statistical_.try_emplace(variant);
    if (is_new) {
        position->second = check_statistical(variant);
    }
    return position->second;
}

Verdict Verifier::check(const Variant& variant) {
    return fp_relaxed(variant, backend_) ? check_freely_rounded(variant) : check_bits(variant);
}

Verdict Verifier::check_film(const Variant& variant) {
    const Variant exact = exact_twin(variant, backend_);
    const Variant reference_variant = reference_on(scene_, exact, backend_);
    const std::string reference_name = shown_name(reference_variant, backend_);
    const RenderResult result = render_part(exact, 0, spp_);
    const RenderResult& expected = reference(reference_variant);
    Verdict verdict{false, result.film.hash(), fault_of(result, exact, backend_, settings_, spp_)};
    if (!verdict.message.empty()) {
        return verdict;
    }
    if (result.film.sums() != expected.film.sums()) {
        const Difference first = first_difference(scene_, settings_, spp_, reference_variant, exact, backend_);
        verdict.message = fmt::format("film differs from {}: {}", reference_name, first.text());
    } else if (const std::string work = difference(imprint_of(result), imprint_of(expected)); !work.empty()) {
        verdict.message = fmt::format("{} of {}", work, reference_name);
    } else {
        verdict.holds = true;
        verdict.message = "film bits equal to " + reference_name;
    }
    return verdict;
}

Verdict Verifier::check_bits(const Variant& variant) {
    const Variant reference_variant = reference_on(scene_, variant, backend_);
    Verdict verdict = check_film(variant);
    if (!verdict.holds) {
        return verdict;
    }
    const auto fail = [&](const std::string& message) {
        verdict.holds = false;
        verdict.message = message;
        return verdict;
    };
    if (backend_ == Backend::cuda) {
        const CpuCheck& cpu = against_cpu(reference_variant);
        if (!cpu.failure.empty()) {
            return fail(cpu.failure);
        }
        verdict.message += cpu.is_made ? " and to the CPU's" : ", which the CPU lacks";
    }
    if (claim_of(variant, backend_) == Claim::statistical) {
        const MeanCheck& check = mean_check(reference_variant);
        if (!check.failure.empty()) {
            return fail("not the declared expectation: " + check.failure);
        }
        verdict.message +=
            fmt::format("; mean as declared (a bias of {:.2g} % would show; the choice moves the mean by {:.2g} %)",
                        100 * check.detectable, 100 * check.effect);
    }
    return verdict;
}

Verdict Verifier::check_freely_rounded(const Variant& variant) {
    const Variant twin = exact_twin(variant, backend_);
    const auto known = bits_.find(twin);
    const Verdict& bits = known != bits_.end() ? known->second : bits_.emplace(twin, check_bits(twin)).first->second;
    const RenderResult result = render_part(variant, 0, spp_);
    Verdict verdict{false, result.film.hash(), ""};
    if (!bits.holds) {
        verdict.message = "its twin " + shown_name(twin, backend_) + " fails: " + bits.message;
    } else if (const std::string fault = fault_of(result, variant, backend_, settings_, spp_); !fault.empty()) {
        verdict.message = fault;
    } else if (const MeanCheck& check = mean_check(variant); !check.failure.empty()) {
        verdict.message = "not the declared expectation: " + check.failure;
    } else {
        verdict.holds = true;
        verdict.message = fmt::format("{}: {}; mean as declared (a bias of {:.2g} % would show)",
                                      shown_name(twin, backend_), bits.message, 100 * check.detectable);
    }
    return verdict;
}

}  // namespace pt
