// The gate before every timing, tried with faults: choices that this file registers (test_*), each wrong in one way
// that is known, and what the gate says of them. A gate that lets one of them through would let a real one through.
#include "harness/bench/verify.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/scenes.h"
#include "variants/compaction/thrust_compaction.h"
#include "variants/variant_name.h"

namespace pt {
namespace {

constexpr std::uint32_t width = 16, height = 12, spp = 3;
// The place of planted faults: one pixel, one sample, one place along the path.
constexpr std::uint32_t bad_pixel = 77, bad_sample = 2;  // pixel 13,4

// ---- Faulty choices ----

// Works like a choice of the program, then does `spoil(queue)`.
class SpoiltCompaction final : public Compaction {
public:
    SpoiltCompaction(const char* name, void (*spoil)(PathQueue&))
        : original_(Registry::instance().find("compaction", name)->hook.compaction()), spoil_(spoil) {}
    void compact(PathQueue& queue) override {
        original_->compact(queue);
        spoil_(queue);
    }

private:
    std::unique_ptr<Compaction> original_;
    void (*spoil_)(PathQueue&);
};

class SpoiltSorting final : public Sorting {
public:
    explicit SpoiltSorting(void (*spoil)(PathQueue&)) : spoil_(spoil) {}
    void sort(PathQueue& queue, std::uint32_t key_count) override {
        original_->sort(queue, key_count);
        spoil_(queue);
    }

private:
    std::unique_ptr<Sorting> original_ = Registry::instance().find("sorting", "bucket")->hook.sorting();
    void (*spoil_)(PathQueue&);
};

// Calls spoil(path, slot) for the path of the bad pixel and sample if it has traced so many segments, and stores it.
template <class Spoil>
void at_the_bad_path(PathQueue& queue, std::uint32_t segments, Spoil spoil) {
    std::visit(
        [&](auto& paths) {
            for (std::size_t i = 0; i < queue.count; ++i) {
                Path<float> path = paths.load(queue.slot(i));
                if (path.pixel == bad_pixel && path.sample == bad_sample && path.segment == segments) {
                    spoil(path, queue.slot(i));
                    paths.store(queue.slot(i), path);
                }
            }
        },
        queue.paths);
}

void drop_the_last(PathQueue& queue) { queue.count -= queue.count > 0 ? 1 : 0; }

// The first path twice, in the slot of one that was taken out.
void double_the_first(PathQueue& queue) {
    std::visit(
        [&](auto& paths) {
            if (queue.count > 0 && queue.count < std::size_t{width} * height) {
                paths.store(queue.count, paths.load(0));
                queue.count += 1;
            }
        },
        queue.paths);
}

// The second path is overwritten by the first: the number of paths stays right.
void overwrite_the_second(PathQueue& queue) {
    std::visit(
        [&](auto& paths) {
            if (queue.count > 1) {
                paths.store(1, paths.load(0));
            }
        },
        queue.paths);
}

void perturb_throughput(PathQueue& queue) {
    at_the_bad_path(queue, 3, [](Path<float>& path, std::uint32_t) { path.throughput *= 1.0001f; });
}

void lose_a_hit(PathQueue& queue) {
    at_the_bad_path(queue, 2, [&](Path<float>&, std::uint32_t slot) { queue.hits[slot] = Hit<float>{}; });
}

Descriptor test_choice(std::string_view axis, std::string_view name) {
    return {.axis = axis, .name = name, .summary = "faulty, for a test", .origin = "this test"};
}

Descriptor test_compaction(std::string_view name) {
    Descriptor descriptor = test_choice("compaction", name);
    descriptor.check_counters = compacted_every_bounce;
    return descriptor;
}

const Registration drops(test_compaction("test_drops"), {.compaction = [] {
                             return std::make_unique<SpoiltCompaction>("thrust_remove_if", drop_the_last);
                         }});
const Registration doubles(test_choice("compaction", "test_doubles"), {.compaction = [] {
                               return std::make_unique<SpoiltCompaction>("thrust_remove_if", double_the_first);
                           }});
const Registration overwrites(test_compaction("test_overwrites"), {.compaction = [] {
                                  return std::make_unique<SpoiltCompaction>("thrust_remove_if", overwrite_the_second);
                              }});
const Registration perturbs(test_compaction("test_perturbs"), {.compaction = [] {
                                return std::make_unique<SpoiltCompaction>("thrust_stable_partition",
                                                                          perturb_throughput);
                            }});
const Registration perturbs_in_place(test_compaction("test_perturbs_in_place"), {.compaction = [] {
                                         return std::make_unique<SpoiltCompaction>("thrust_copy_if_index",
                                                                                   perturb_throughput);
                                     }});

class LazyCompaction final : public Compaction {
public:
    void compact(PathQueue&) override {}
};
const Registration lazy(test_compaction("test_lazy"),
                        {.compaction = [] { return std::make_unique<LazyCompaction>(); }});

void count_too_many(PathQueue& queue) { queue.count += 100000; }

const Registration counts_too_many(test_compaction("test_counts_too_many"), {.compaction = [] {
                                       return std::make_unique<SpoiltCompaction>("thrust_remove_if", count_too_many);
                                   }});
const Registration sorts_too_many(test_choice("sorting", "test_sorts_too_many"),
                                  {.sorting = [] { return std::make_unique<SpoiltSorting>(count_too_many); }});

const Registration loses_a_hit(test_choice("sorting", "test_loses_a_hit"),
                               {.sorting = [] { return std::make_unique<SpoiltSorting>(lose_a_hit); }});

// A light choice that claims bits but adds light, and one that claims light but adds none.
const Registration brightens(test_choice("direct_light", "test_brightens"),
                             {.features = [] { return no_features | Feature::final_bounce; }});
Descriptor statistical_choice(std::string_view axis, std::string_view name, std::string_view mean_of,
                              std::uint32_t extra_depth) {
    Descriptor descriptor = test_choice(axis, name);
    descriptor.claim = Claim::statistical;
    descriptor.claim_note = "for a test";
    descriptor.mean_of = mean_of;
    descriptor.mean_at_extra_depth = extra_depth;
    return descriptor;
}
const Registration adds_nothing(statistical_choice("direct_light", "test_adds_nothing", "off", 1),
                                {.features = [] { return no_features; }});

RenderFunction generic_kernel(const char* integrator) {
    return Registry::instance().find("integrator", integrator)->hook.integrator.at(all_features);
}

void render_nothing(RenderJob&) {}

// The null kernel that also lies about its work.
void render_nothing_and_lie(RenderJob& job) {
    const FilmView film = job.film;
    const std::vector<std::int64_t> before(film.sums, film.sums + std::size_t{3} * job.scene.pixel_count());
    generic_kernel("depth_first")(job);
    std::copy(before.begin(), before.end(), film.sums);
}

void count_a_ray_too_many(RenderJob& job) {
    generic_kernel("depth_first")(job);
    job.work.rays += 1;
}

void count_a_path_too_few(RenderJob& job) {
    generic_kernel("depth_first")(job);
    job.work.paths -= 1;
}

void add_a_nan(RenderJob& job) {
    generic_kernel("depth_first")(job);
    job.film.add(5, Vec3<float>(std::numeric_limits<float>::quiet_NaN()));
}

void add_a_negative(RenderJob& job) {
    generic_kernel("depth_first")(job);
    job.film.add(5, Vec3<float>(0, -1, 0));
}

// A variant whose film is wrong only if it takes more than one sample at once.
void spoil_the_sum(RenderJob& job) {
    generic_kernel("depth_first")(job);
    if (job.samples > 1) {
        job.film.sums[3 * 20 + 1] += 1;  // one quantum in pixel 4,1
    }
}

// A variant with other random numbers, and so another film of the same expectation.
void take_other_samples(RenderJob& job) {
    job.first_sample += 1000;
    generic_kernel("depth_first")(job);
}

void take_other_samples_one_percent_brighter(RenderJob& job) {
    take_other_samples(job);
    for (std::size_t i = 0; i < std::size_t{3} * job.scene.pixel_count(); ++i) {
        job.film.sums[i] += job.film.sums[i] / 100;
    }
}

// The film is right where there are at least as many rays as samples.
void ignore_the_cache(RenderJob& job) {
    job.cache = nullptr;
    generic_kernel("depth_first")(job);
}

void use_one_ray_too_few(RenderJob& job) {
    job.cache->rays -= 1;
    generic_kernel("depth_first")(job);
}

// A kernel that the compiler rounds as it likes, and that may do so wrongly.
Descriptor freely_rounded(std::string_view axis, std::string_view name, std::string_view mean_of) {
    Descriptor descriptor = statistical_choice(axis, name, mean_of, 0);
    descriptor.fp_relaxed = true;
    return descriptor;
}
const Registration rounds_freely_by_name(freely_rounded("arithmetic", "test_freely", "exact"), {});

const IntegratorRegistration integrators[] = {
    {test_choice("integrator", "test_ignores_cache"), all_features, ignore_the_cache},
    {test_choice("integrator", "test_ray_too_few"), all_features, use_one_ray_too_few},
    {freely_rounded("integrator", "test_freely", "depth_first"), all_features, take_other_samples},
    {freely_rounded("integrator", "test_freely_brighter", "depth_first"), all_features,
     take_other_samples_one_percent_brighter},
    {freely_rounded("integrator", "test_freely_nan", "depth_first"), all_features, add_a_nan},
    {freely_rounded("integrator", "test_freely_no_cache", "depth_first"), all_features, ignore_the_cache},
    {freely_rounded("integrator", "test_freely_path_too_few", "depth_first"), all_features, count_a_path_too_few},
    {statistical_choice("integrator", "test_other_samples", "depth_first", 0), all_features, take_other_samples},
    {statistical_choice("integrator", "test_one_percent_brighter", "depth_first", 0), all_features,
     take_other_samples_one_percent_brighter},
    {test_choice("integrator", "test_null"), all_features, render_nothing},
    {test_choice("integrator", "test_null_lies"), all_features, render_nothing_and_lie},
    {test_choice("integrator", "test_ray_too_many"), all_features, count_a_ray_too_many},
    {test_choice("integrator", "test_path_too_few"), all_features, count_a_path_too_few},
    {test_choice("integrator", "test_nan"), all_features, add_a_nan},
    {test_choice("integrator", "test_negative"), all_features, add_a_negative},
    {test_choice("integrator", "test_spoilt_sum"), all_features, spoil_the_sum},
};

// ---- Scenes: every segment of every path meets light, so a fault shows where it happens ----

// A closed room: paths end only when they are exhausted, after 6 segments.
Scene closed_room() {
    test::SceneBuilder builder;
    builder.room(builder.diffuse({0.6, 0.5, 0.4}, {0.2, 0.3, 0.4}), {0, 0, 0}, {2, 2, 2});
    builder.sphere(builder.diffuse({0.8, 0.8, 0.8}, {0.1, 0, 0.1}), {0.3, -0.4, 1}, 0.9);
    builder.image(width, height, 70, true).depth(6);
    return builder.scene;
}

// A scene without walls, in a bright environment: paths leave at any segment.
Scene open_scene() {
    test::SceneBuilder builder;
    builder.environment(0.5);
    const std::uint32_t glow = builder.diffuse({0.6, 0.5, 0.4}, {0.2, 0.3, 0.4});
    builder.quad(glow, {0, -1, 3}, 6, 6);
    builder.quad(glow, {0, 1, 5}, 6, 4, {-90, 0, 0});
    builder.sphere(builder.diffuse({0.8, 0.8, 0.8}, {0.1, 0, 0.1}), {0.3, -0.4, 3}, 0.9);
    builder.image(width, height, 70, true).depth(3);
    return builder.scene;
}

Variant with(const std::string& axis, const std::string& choice) {
    Variant variant = Registry::instance().baseline();
    variant.set(axis, choice);
    return variant;
}

Verdict check(const Scene& scene, const Variant& variant) {
    return Verifier(scene, default_settings(scene), spp).check(variant);
}

Variant keeping_camera_rays(std::uint32_t rays, const std::string& integrator = "wavefront") {
    Variant variant = with("first_bounce", "cached_jitters");
    variant.set("integrator", integrator);
    if (rays != 16) {  // the standard
        variant.tuning["jitters"] = rays;
    }
    return variant;
}

const std::string reference = "depth_first specialisation=generic";

// ---- Good variants ----

TEST(VerifyTest, GoodVariantsHold) {
    const Scene scene = open_scene();
    Verifier verifier(scene, default_settings(scene), spp);
    std::string hash;
    for (const auto& [axis, choice] : std::vector<std::pair<std::string, std::string>>{
             {"integrator", "wavefront"},
             {"integrator", "depth_first"},
             {"compaction", "thrust_remove_if"},
             {"compaction", "thrust_copy_if_index"},
             {"sorting", "bucket"},
             {"layout", "soa"},
             {"specialisation", "generic"},
         }) {
        const Verdict verdict = verifier.check(with(axis, choice));
        EXPECT_TRUE(verdict.holds) << verdict.message;
        EXPECT_EQ(verdict.message, "film bits equal to " + reference);
        EXPECT_EQ(verdict.film_hash.size(), 16u);
        EXPECT_TRUE(hash.empty() || verdict.film_hash == hash);
        hash = verdict.film_hash;
    }
    const Verdict lit = verifier.check(with("direct_light", "final_bounce"));
    EXPECT_TRUE(lit.holds) << lit.message;
    EXPECT_EQ(lit.message.find("film bits equal to "
                               "depth_first direct_light=final_bounce specialisation=generic; "
                               "mean as declared (a "
                               "bias of "),
              0u)
        << lit.message;
    EXPECT_NE(lit.film_hash, hash);
}

// A biased choice is held to the plainest variant with the same bias: the same choice, tuned alike.
TEST(VerifyTest, ABiasedVariantIsHeldToTheBitsOfItsOwnReference) {
    const Scene scene = closed_room();
    Verifier verifier(scene, default_settings(scene), spp);
    const std::string biased = "depth_first first_bounce=cached_jitters specialisation=generic";
    std::set<std::string> hashes;
    for (const std::uint32_t rays : {1u, 2u, 16u}) {
        const Verdict verdict = verifier.check(keeping_camera_rays(rays));
        EXPECT_TRUE(verdict.holds) << verdict.message;
        EXPECT_EQ(verdict.message,
                  "film bits equal to " + biased + (rays == 16 ? "" : " jitters=" + std::to_string(rays)));
        EXPECT_EQ(verifier.check(keeping_camera_rays(rays, "depth_first")).film_hash, verdict.film_hash);
        hashes.insert(verdict.film_hash);
    }
    EXPECT_EQ(hashes.size(), 3u);
    // 3 samples have 3 of the 16 rays: the film of first_bounce=off.
    EXPECT_TRUE(hashes.contains(verifier.check(with("integrator", "wavefront")).film_hash));
}

// ---- Planted faults ----

TEST(VerifyTest, ADroppedPathIsFound) {
    const Verdict verdict = check(closed_room(), with("compaction", "test_drops"));
    EXPECT_FALSE(verdict.holds);
    // The last path is that of the last pixel, lost after the first bounce of each sample; then that before it.
    EXPECT_EQ(verdict.message, "film differs from " + reference + ": first at pixel 11,11, sample 0, bounce 6");
}

TEST(VerifyTest, ADoubledPathIsFound) {
    const Verdict verdict = check(open_scene(), with("compaction", "test_doubles"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_NE(verdict.message.find("film differs from " + reference + ": first at pixel "), std::string::npos)
        << verdict.message;
}

TEST(VerifyTest, ADoubledPathInPlaceOfAnotherIsFound) {
    const Verdict verdict = check(closed_room(), with("compaction", "test_overwrites"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message, "film differs from " + reference + ": first at pixel 0,0, sample 0, bounce 2");
}

TEST(VerifyTest, NamesPixelSampleAndBounceOfAPerturbedThroughput) {
    // Spoilt after the third segment: the fourth is the first whose light is wrong.
    for (const char* compaction : {"test_perturbs", "test_perturbs_in_place"}) {
        const Verdict verdict = check(closed_room(), with("compaction", compaction));
        EXPECT_FALSE(verdict.holds);
        EXPECT_EQ(verdict.message, "film differs from " + reference + ": first at pixel 13,4, sample 2, bounce 4");
    }
}

TEST(VerifyTest, NamesPixelSampleAndBounceOfALostHit) {
    // Lost before the third segment is shaded; a queue is not sorted for a path's last segment, so it takes paths of
    // four to show it.
    const Verdict verdict = check(closed_room(), with("sorting", "test_loses_a_hit"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message, "film differs from " + reference + ": first at pixel 13,4, sample 2, bounce 4");
}

TEST(VerifyTest, FirstDifferenceSpeaksOfTheSamplesTogetherWhereEachAloneAgrees) {
    const Verdict verdict = check(closed_room(), with("integrator", "test_spoilt_sum"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message,
              "film differs from " + reference + ": first at pixel 4,1, in how its samples are put together");
}

TEST(VerifyTest, ANullKernelIsFound) {
    EXPECT_EQ(check(closed_room(), with("integrator", "test_null")).message, "0 paths for 192 pixels of 3 samples");
    EXPECT_EQ(check(closed_room(), with("integrator", "test_null_lies")).message,
              "film differs from " + reference + ": first at pixel 0,0, sample 0, bounce 1");
    // In a scene without light the films agree; the work does not.
    Scene dark = closed_room();
    for (SceneMaterial& material : dark.materials) {
        material.emission = Vec3d(0.0);
    }
    EXPECT_FALSE(check(dark, with("integrator", "test_null")).holds);
    EXPECT_TRUE(check(dark, with("integrator", "depth_first")).holds);
}

TEST(VerifyTest, WorkThatWasNotDoneIsFound) {
    const std::string lazy_message = check(open_scene(), with("compaction", "test_lazy")).message;
    EXPECT_EQ(lazy_message.find("compaction=test_lazy: 0 paths taken out and "), 0u) << lazy_message;
    EXPECT_EQ(check(closed_room(), with("integrator", "test_path_too_few")).message,
              "575 paths for 192 pixels of 3 samples");
    EXPECT_EQ(check(closed_room(), with("integrator", "test_ray_too_many")).message,
              "3457 rays, not 3456 of " + reference);
}

// Nobody looks at what lies behind the queue.
TEST(VerifyTest, ACountBeyondTheQueueIsRefused) {
    const auto refusal = [](const Variant& variant) -> std::string {
        try {
            check(closed_room(), variant);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(with("compaction", "test_counts_too_many")),
              "the compaction returned a count of 100192 paths in play, allowed: at most 192, as many as it was given");
    EXPECT_EQ(refusal(with("sorting", "test_sorts_too_many")),
              "the sort changed the count of paths in play from 192 to 100192, allowed: the same");
}

// The film cannot tell: with 16 rays for 3 samples it is the right one.
TEST(VerifyTest, ACacheThatWasNotUsedIsFound) {
    for (const std::uint32_t rays : {1u, 3u, 16u}) {
        const Verdict verdict = check(closed_room(), keeping_camera_rays(rays, "test_ignores_cache"));
        EXPECT_FALSE(verdict.holds);
        EXPECT_EQ(verdict.message, "first_bounce=cached_jitters: 0 cache fills for 576 paths");
    }
}

TEST(VerifyTest, AWrongRayOfTheCacheIsFound) {
    const Verdict verdict = check(closed_room(), keeping_camera_rays(2, "test_ray_too_few"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message.find("film differs from depth_first first_bounce=cached_jitters specialisation=generic "
                                   "jitters=2: first at pixel "),
              0u)
        << verdict.message;
    EXPECT_NE(verdict.message.find(", sample 1, bounce "), std::string::npos) << verdict.message;
}

TEST(VerifyTest, FaultySamplesAreFound) {
    EXPECT_EQ(check(closed_room(), with("integrator", "test_nan")).message,
              "1 non-finite, 0 negative and 0 saturated samples");
    EXPECT_EQ(check(closed_room(), with("integrator", "test_negative")).message,
              "0 non-finite, 1 negative and 0 saturated samples");
}

TEST(VerifyTest, AClaimOfBitsThatChangesTheLightIsFound) {
    const Verdict verdict = check(closed_room(), with("direct_light", "test_brightens"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message, "film differs from " + reference + ": first at pixel 0,0, sample 0, bounce 1");
}

// ---- Statistical claims ----

TEST(VerifyTest, ADeclaredExpectationThatIsNotMetIsFound) {
    const Verdict verdict = check(closed_room(), with("direct_light", "test_adds_nothing"));
    EXPECT_FALSE(verdict.holds);
    EXPECT_EQ(verdict.message.find("not the declared expectation: "), 0u) << verdict.message;
    EXPECT_NE(verdict.message.find(" of direct_light=off at depth 7 ("), std::string::npos) << verdict.message;
}

// Puts a kernel in the place of the reference kernel whose light connections are off by a factor.
class BiasedReference {
public:
    explicit BiasedReference(double factor) {
        original_ = generic_kernel("depth_first");
        factor_ = factor;
        set([](RenderJob& job) {
            original_(job);
            const std::size_t sums = job.scene.final_bounce != 0 ? std::size_t{3} * job.scene.pixel_count() : 0;
            for (std::size_t i = 0; i < sums; ++i) {
                job.film.sums[i] = static_cast<std::int64_t>(static_cast<double>(job.film.sums[i]) * factor_);
            }
        });
    }
    ~BiasedReference() { set(original_); }

private:
    static void set(RenderFunction function) {
        Registry::instance().add_integrator(Registry::instance().find("integrator", "depth_first")->descriptor,
                                            all_features, function);
    }
    static inline RenderFunction original_ = nullptr;
    static inline double factor_ = 1;
};

// The variant that is its own reference, so that only the statistical claim can fail.
Variant lit_reference() {
    Variant variant = with("direct_light", "final_bounce");
    variant.set("integrator", "depth_first");
    variant.set("specialisation", "generic");
    return variant;
}

TEST(VerifyTest, AStatisticalIntegratorIsHeldToItsMean) {
    const Verdict good = check(closed_room(), with("integrator", "test_other_samples"));
    EXPECT_TRUE(good.holds) << good.message;
    EXPECT_EQ(good.message.find("film bits equal to "
                                "test_other_samples specialisation=generic; "
                                "mean as declared ("),
              0u)
        << good.message;
    const Verdict biased = check(closed_room(), with("integrator", "test_one_percent_brighter"));
    EXPECT_FALSE(biased.holds);
    EXPECT_NE(biased.message.find(" of integrator=depth_first at depth 6 ("), std::string::npos) << biased.message;
}

// ---- Kernels that round freely: their twin is held to bits, they to their twin's mean ----

TEST(VerifyTest, WhatRoundsFreelyIsHeldToItsTwinsMean) {
    const Verdict same = check(closed_room(), with("arithmetic", "test_freely"));
    EXPECT_TRUE(same.holds) << same.message;
    EXPECT_EQ(same.message.find(shown_name(Registry::instance().baseline(), Backend::cpu) + ": film bits equal to " +
                                reference + "; mean as declared (a bias of "),
              0u)
        << same.message;
    const Verdict other = check(closed_room(), with("integrator", "test_freely"));
    EXPECT_TRUE(other.holds) << other.message;
    EXPECT_EQ(other.message.find("depth_first: film bits "
                                 "equal to " +
                                 reference + "; mean as declared (a bias of "),
              0u)
        << other.message;
    EXPECT_NE(other.film_hash, same.film_hash);  // its own, not its twin's
}

TEST(VerifyTest, WhatRoundsFreelyAndWrongIsFound) {
    const std::pair<const char*, const char*> cases[] = {
        {"test_freely_brighter", "not the declared expectation: "},
        {"test_freely_nan", "1 non-finite, 0 negative and 0 saturated samples"},
        {"test_freely_path_too_few", "575 paths for 192 pixels of 3 samples"},
    };
    for (const auto& [integrator, message] : cases) {
        const Verdict verdict = check(closed_room(), with("integrator", integrator));
        EXPECT_FALSE(verdict.holds) << integrator;
        EXPECT_EQ(verdict.message.find(message), 0u) << verdict.message;
    }
    const Verdict uncached = check(closed_room(), keeping_camera_rays(16, "test_freely_no_cache"));
    EXPECT_FALSE(uncached.holds);
    EXPECT_EQ(uncached.message, "first_bounce=cached_jitters: 0 cache fills for 576 paths");
}

TEST(VerifyTest, WhatRoundsFreelyFailsWithItsTwin) {
    Variant variant = with("compaction", "test_perturbs");
    variant.set("arithmetic", "test_freely");
    const Scene scene = closed_room();
    Verifier verifier(scene, default_settings(scene), spp);
    for (int call = 0; call < 2; ++call) {  // the twin's verdict is remembered
        const Verdict verdict = verifier.check(variant);
        EXPECT_FALSE(verdict.holds);
        EXPECT_EQ(verdict.message, "its twin " + shown_name(with("compaction", "test_perturbs"), Backend::cpu) +
                                       " fails: film differs from " + reference +
                                       ": first at pixel 13,4, sample 2, bounce 4");
    }
}

// The bias of the image's mean that a passing verdict says it would have seen, in percent.
double stated_percent(const Verdict& verdict) {
    const std::size_t start = verdict.message.find("(a bias of ");
    return start == std::string::npos ? 0 : std::stod(verdict.message.substr(start + 11));
}

// What can be found depends on the scene's noise and on the samples (24 batches of at least 4 a pixel): 0.6 % in this
// room at 16x12, 5 to 8 % in the Cornell boxes at 64x64. A passing verdict states it, so the claim is tested too.
TEST(VerifyTest, ABiasOfTheStatedSizeIsFound) {
    const Scene scene = closed_room();
    const double percent = stated_percent(check(scene, lit_reference()));
    EXPECT_GT(percent, 0.01);
    EXPECT_LT(percent, 1);
    for (const double factor : {1 - 0.02 * percent, 1 + 0.02 * percent}) {
        const BiasedReference biased(factor);
        EXPECT_FALSE(check(scene, lit_reference()).holds) << factor;
    }
}

TEST(VerifyTest, AOnePercentBiasOfADeclaredExpectationIsFound) {
    const Scene scene = closed_room();
    EXPECT_TRUE(check(scene, lit_reference()).holds);
    for (const double factor : {0.99, 1.01}) {
        const BiasedReference biased(factor);
        const Verdict verdict = check(scene, lit_reference());
        EXPECT_FALSE(verdict.holds);
        EXPECT_EQ(verdict.message.find("not the declared expectation: "), 0u) << verdict.message;
    }
    EXPECT_TRUE(check(scene, lit_reference()).holds);
}

// What is compiled before the first is rendered: the rest would be compiled by itself, while nothing is said.
TEST(VerifyTest, NamesAllThatItRendersOfAVariant) {
    if (Registry::instance().choices("integrator", Backend::cuda).empty()) {
        GTEST_SKIP() << "this build has no CUDA backend";
    }
    const auto names = [](const Variant& variant) {
        std::set<std::string> all;
        for (const Variant& rendered : rendered_to_check(closed_room(), variant, Backend::cuda)) {
            all.insert(shown_name(rendered, Backend::cuda));
        }
        return all;
    };
    Variant variant = Registry::instance().baseline(Backend::cuda);
    variant.set("integrator", "persistent");
    variant.set("arithmetic", "precise");
    variant.set("direct_light", "final_bounce");
    const std::set<std::string> expected{
        "persistent direct_light=final_bounce",                          // itself
        "persistent direct_light=final_bounce arithmetic=exact",         // its twin
        "megakernel direct_light=final_bounce arithmetic=exact room=0",  // whose bits the twin has
        "megakernel arithmetic=exact room=0",                            // whose mean these have
        "persistent arithmetic=exact",                                   // whose mean the variant has
    };
    EXPECT_EQ(names(variant), expected);
}

}  // namespace
}  // namespace pt
