#include "harness/cli/verify_films.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

constexpr std::uint32_t large_width = 128, large_height = 96;

// Checks one variant of each choice on a larger film: a queue of over ten thousand paths, compacted over sixty times,
// shows faults that do not occur at 64x64 and 4 spp. Too slow for every variant.
class LargeCheck {
public:
    LargeCheck(const Scene& scene, Backend backend, const std::vector<Variant>& variants,
               const VerifyArguments& arguments)
        : spp_(samples_for(settings_of(scene, arguments).depth)),
          verifier_(scene, large(scene, arguments), spp_, backend) {
        if (arguments.names_no_size()) {
            checked_ = plainest_of_each_choice(scene, variants, backend);
        }
    }

    // The final verdict on a variant: `verdict`, from its film of normal size, unless its larger film has faults.
    Verdict after(const Verdict& verdict, const Variant& variant) {
        if (!verdict.holds || !checked_.contains(variant)) {
            return verdict;
        }
        Verdict at_large = verifier_.check_film(variant);
        at_large.message = fmt::format("at {}, {} spp: {}", size_of_large_films(), spp_, at_large.message);
        return at_large.holds ? verdict : at_large;
    }

private:
    static std::uint32_t samples_for(std::uint32_t depth) {
        constexpr std::uint32_t compactions = 70;  // compactions in a render: one per path segment but the last
        return std::max(4u, compactions / std::max(1u, depth - 1) + 1);
    }
    static RenderSettings large(const Scene& scene, const VerifyArguments& arguments) {
        RenderSettings settings = settings_of(scene, arguments);
        settings.width = large_width;
        settings.height = large_height;
        return settings;
    }
    // For each choice, the variant with this choice that otherwise differs least from the baseline.
    static std::set<Variant> plainest_of_each_choice(const Scene& scene, const std::vector<Variant>& variants,
                                                     Backend backend) {
        const Variant baseline = Registry::instance().baseline(backend);
        const auto distance = [&](const Variant& variant) {
            return std::count_if(axis_names.begin(), axis_names.end(),
                                 [&](std::string_view axis) { return variant[axis] != baseline[axis]; });
        };
        std::map<std::pair<std::string_view, std::string>, std::pair<std::ptrdiff_t, const Variant*>> plainest;
        const FeatureSet features = features_of(scene);
        for (const Variant& variant : variants) {
            if (!why_not_applicable(variant, features, backend).empty()) {
                continue;
            }
            const std::pair here(distance(variant), &variant);
            for (const std::string_view axis : axis_names) {
                const auto [known, is_new] = plainest.try_emplace({axis, variant[axis]}, here);
                if (here.first < known->second.first) {
                    known->second = here;
                }
            }
        }
        std::set<Variant> chosen;
        for (const auto& [choice, of_choice] : plainest) {
            chosen.insert(*of_choice.second);
        }
        return chosen;
    }

    std::uint32_t spp_;
    Verifier verifier_;
    std::set<Variant> checked_;
};

// The checks of one scene. Reference films that several variants share are rendered once.
class SceneChecks {
public:
    SceneChecks(const Scene& scene, Backend backend, const std::vector<Variant>& variants,
                const VerifyArguments& arguments)
        : verifier_(scene, settings_of(scene, arguments), arguments.samples(), backend),
          large_check_(scene, backend, variants, arguments) {}

    // Verifies a variant; an exception counts as a failure, so that other variants are still checked.
    Verdict verdict_on(const Variant& variant) {
        try {
            return large_check_.after(verifier_.check(variant), variant);
        } catch (const std::exception& exception) {
            return {false, "no film", exception.what()};
        }
    }

private:
    Verifier verifier_;
    LargeCheck large_check_;
};

// Variants that one process checks in sequence.
struct Part {
    std::size_t scene;
    std::vector<std::size_t> variants;  // indices of variants among those to verify on the scene
};

// The number of variants in a part, so that each process gets several parts and a slow one delays few others.
std::size_t part_size(std::size_t variants, std::size_t processes) {
    return processes <= 1 ? 1 : std::clamp<std::size_t>(variants / (4 * processes), 1, 16);
}

// The variants to verify: those that apply, split into parts, and for each scene those that do not apply.
struct PartedFilms {
    std::vector<Part> parts;
    std::vector<NotApplicableLines> not_applicable;
};

PartedFilms in_parts(const FilmsToVerify& films, std::size_t processes) {
    std::size_t all = 0;
    for (const std::vector<Variant>& variants : films.variants) {
        all += variants.size();
    }
    const std::size_t size = part_size(all, processes);
    PartedFilms parted{{}, std::vector<NotApplicableLines>(films.scenes.size())};
    std::vector<Part>& parts = parted.parts;
    for (std::size_t scene = 0; scene < films.scenes.size(); ++scene) {
        const FeatureSet features = features_of(films.scenes[scene]);
        const std::vector<Variant>& variants = films.variants[scene];
        for (std::size_t i = 0; i < variants.size(); ++i) {
            const std::string reason = why_not_applicable(variants[i], features, films.backend);
            if (!reason.empty()) {
                parted.not_applicable[scene].add(shown_name(variants[i], films.backend), reason);
                continue;
            }
            if (parts.empty() || parts.back().scene != scene || parts.back().variants.size() == size) {
                parts.push_back({scene, {}});
            }
            parts.back().variants.push_back(i);
        }
    }
    return parted;
}

// The question that asks a worker to check a part (some variants of one scene); a message quotes it if the worker dies.
std::string question_of(const FilmsToVerify& films, const Part& part) {
    return fmt::format("{} on {}, part from {}", films.scenes[part.scene].name, to_string(films.backend),
                       shown_name(films.variants[part.scene][part.variants.front()], films.backend));
}

// Checks parts (variants of a scene). An answer is a JSON object: lines to print, numbers of good and bad variants.
class PartChecker {
public:
    PartChecker(const FilmsToVerify& films, const VerifyArguments& arguments)
        : films_(films), arguments_(arguments), scenes_(films.scenes.size()) {}

    std::string answer(const Part& part) {
        const Scene& scene = films_.scenes[part.scene];
        const std::vector<Variant>& variants = films_.variants[part.scene];
        std::optional<SceneChecks>& checks = scenes_[part.scene];
        if (!checks) {
            checks.emplace(scene, films_.backend, variants, arguments_);
        }
        std::string text;
        std::size_t held = 0;
        for (const std::size_t i : part.variants) {
            const Verdict verdict = checks->verdict_on(variants[i]);
            held += verdict.holds ? 1 : 0;
            if (!verdict.holds || !arguments_.quiet) {
                text += fmt::format("{} {} on {}: {}, {}\n", verdict.film_hash, shown_name(variants[i], films_.backend),
                                    scene.name, verdict.holds ? "ok" : "FAILED", verdict.message);
            }
        }
        return nlohmann::json{{"text", text}, {"held", held}, {"failed", part.variants.size() - held}}.dump();
    }

private:
    const FilmsToVerify& films_;
    const VerifyArguments& arguments_;
    std::vector<std::optional<SceneChecks>> scenes_;
};

// A worker process's scenes and variants, and its parts by the question that names them; made at the first question.
struct WorkerFilms {
    WorkerFilms(FilmsToVerify prepared, const VerifyArguments& arguments)
        : films(std::move(prepared)), checker(films, arguments) {
        for (Part& part : in_parts(films, processes_for_films(arguments)).parts) {
            parts.emplace(question_of(films, part), std::move(part));
        }
    }
    FilmsToVerify films;
    PartChecker checker;
    std::map<std::string, Part> parts;
};

}  // namespace

std::string size_of_large_films() { return fmt::format("{}x{}", large_width, large_height); }

std::size_t processes_for_films(const VerifyArguments& arguments) {
    if (arguments.jobs != 0) {
        return arguments.jobs;
    }
    return arguments.backend == "cpu" ? 1 : std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 4);
}

bool uses_processes(const VerifyArguments& arguments, Backend backend) {
    return processes_for_films(arguments) > 1 && (arguments.jobs != 0 || backend == Backend::cuda);
}

Workers film_checkers(std::size_t count, const VerifyArguments& arguments, std::function<FilmsToVerify()> prepared) {
    auto films = std::make_shared<std::optional<WorkerFilms>>();
    const auto list = [&arguments, prepared = std::move(prepared), films] {
        if (!*films) {
            films->emplace(prepared(), arguments);
        }
    };
    const auto answer = [list, films](const std::string& question) {
        list();
        return (*films)->checker.answer((*films)->parts.at(question));
    };
    return Workers(count, answer, [&arguments, list] {
        if (uses_processes(arguments, parse_backend(arguments.backend))) {
            list();
        }
    });
}

Tally verify_films(const FilmsToVerify& films, const VerifyArguments& arguments, Workers* workers) {
    const PartedFilms parted = in_parts(films, workers != nullptr ? processes_for_films(arguments) : 1);
    const std::vector<Part>& parts = parted.parts;
    std::size_t variants = 0;
    std::vector<std::string> questions;
    for (const Part& part : parts) {
        variants += part.variants.size();
        questions.push_back(question_of(films, part));
    }
    Tally tally;
    std::size_t next_scene = 0;
    Progress progress = progress_of(variants, arguments);
    const auto finish_scenes_before = [&](std::size_t scene) {
        for (; next_scene < scene; ++next_scene) {
            const NotApplicableLines& lines = parted.not_applicable[next_scene];
            tally.not_applicable += lines.variants();
            if (!arguments.quiet) {
                lines.print(films.scenes[next_scene].name);
            }
        }
    };
    const auto answered = [&](std::size_t index, const std::string& answer) {
        const nlohmann::json found = nlohmann::json::parse(answer);
        const Part& part = parts[index];
        finish_scenes_before(part.scene);
        fmt::print("{}", found["text"].get<std::string>());
        std::fflush(stdout);
        tally.held += found["held"].get<std::size_t>();
        tally.failed += found["failed"].get<std::size_t>();
        for (const std::size_t i : part.variants) {
            progress.step(shown_name(films.variants[part.scene][i], films.backend));
        }
    };
    if (workers != nullptr) {
        workers->ask(questions, answered);
    } else {
        PartChecker checker(films, arguments);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            progress.begin(shown_name(films.variants[parts[i].scene][parts[i].variants.front()], films.backend));
            answered(i, checker.answer(parts[i]));
        }
    }
    finish_scenes_before(films.scenes.size());
    return tally;
}

}  // namespace pt
