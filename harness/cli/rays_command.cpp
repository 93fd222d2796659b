// `ptbench rays`: rates of ray batches without shading.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include "harness/cli/commands.h"
#include "harness/cli/known_names.h"
#include "harness/counted.h"
#include "harness/cuda/backend.h"
#include "harness/files_read.h"
#include "harness/json_reader.h"
#include "harness/machine/machine.h"
#include "harness/machine/run_context.h"
#include "harness/mesh/write_mesh.h"
#include "harness/nearest_name.h"
#include "harness/rays/gpu_batch.h"
#include "harness/rays/leak_study.h"
#include "harness/rays/ray_counters.h"
#include "harness/rays/ray_file.h"
#include "harness/rays/ray_sets.h"
#include "harness/rays/ray_study.h"
#include "harness/write_file.h"
#include "variants/registry.h"

namespace pt {

namespace {

struct RaysArguments {
    std::string meshes, scenes, classes, accelerators, builders, backend, out, write_rays, read_rays, write_mesh;
    std::uint32_t log2_rays = 20, checked = 1024;
    int repetitions = 9, threads = 0;
    std::uint64_t first_ray = 0, seed = 1;
    bool leaks = false, overwrite = false;
    bool counters = false, counted = false;  // counted: whether --counters started this process under ncu
    std::string command_line;
};

// Splits the names in an option's value; each must be among `known`.
std::vector<std::string> chosen(const std::string& text, const std::string& flag,
                                const std::vector<std::string>& known) {
    const std::vector<std::string> names = split_names(text, flag);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            throw InputError(flag, "name", "\"" + name + "\"",
                             fmt::format("{}{}", fmt::join(known, ", "), did_you_mean(name, known)));
        }
    }
    return names;
}

std::vector<std::string> accelerators_on(Backend backend) {
    std::vector<std::string> names;
    const std::vector<std::string> compiled =
        backend == Backend::cuda ? rays::gpu_accelerators() : std::vector<std::string>();
    for (const Choice* choice : Registry::instance().choices(axes::accelerator, backend)) {
        const std::string name(choice->descriptor.name);
        if (backend == Backend::cpu || std::find(compiled.begin(), compiled.end(), name) != compiled.end()) {
            names.push_back(name);
        }
    }
    return names;
}

// Names of the backend's accelerators with a tree, which the axis `builder` builds.
std::vector<std::string> trees_on(Backend backend) {
    std::vector<std::string> names = accelerators_on(backend);
    std::erase_if(names, [](const std::string& name) {
        const Choice* choice = Registry::instance().find(axes::accelerator, name);
        return !traits_in<AcceleratorTraits>(choice->descriptor).has_tree;
    });
    return names;
}

std::vector<std::string> builders_on(Backend backend) {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices(axes::builder, backend)) {
        names.emplace_back(choice->descriptor.name);
    }
    return names;
}

void check_given(const std::vector<rays::RaySet>& sets, const std::vector<std::string>& classes,
                 const std::string& file) {
    std::vector<std::string> names;
    for (const rays::RaySet& set : sets) {
        names.push_back(set.name);
    }
    for (const std::string& name : classes) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw InputError(file, "class", "no set of \"" + name + "\"", fmt::format("{}", fmt::join(names, ", ")));
        }
    }
}

rays::RayStudy study_of(const RaysArguments& arguments) {
    rays::RayStudy study;
    study.backend = parse_backend(arguments.backend);
    require_backend(study.backend);
    study.accelerators = arguments.accelerators.empty()
                             ? trees_on(study.backend)
                             : chosen(arguments.accelerators, "--accelerator", accelerators_on(study.backend));
    study.builders =
        chosen(arguments.builders.empty() ? "sah_binned" : arguments.builders, "--builder", builders_on(study.backend));
    if (!arguments.read_rays.empty()) {
        study.given = rays::read_rays(arguments.read_rays);
    }
    std::vector<std::string> known = rays::ray_classes();
    if (!study.given.empty()) {
        known.clear();
        for (const rays::RaySet& set : study.given) {
            known.push_back(set.name);
        }
    }
    study.classes = arguments.classes.empty() ? known : chosen(arguments.classes, "--class", known);
    check_given(study.given, study.given.empty() ? std::vector<std::string>() : study.classes, arguments.read_rays);
    study.log2_rays = arguments.log2_rays;
    study.repetitions = arguments.repetitions;
    study.checked = arguments.checked;
    return study;
}

std::vector<std::string> names_or_none(const std::string& text, const std::string& flag) {
    return text.empty() ? std::vector<std::string>() : split_names(text, flag);
}

// Checks all arguments of `ptbench rays` before any work is done.
void check_arguments(const RaysArguments& arguments, std::size_t meshes) {
    if (meshes == 0) {
        throw InputError("rays", "--mesh", "none", "--mesh NAME:SIZE|FILE,.. or --scene S,..");
    }
    for (const auto& [flag, file] : {std::pair<const char*, const std::string&>{"--read-rays", arguments.read_rays},
                                     {"--write-rays", arguments.write_rays},
                                     {"--write-mesh", arguments.write_mesh}}) {
        if (!file.empty() && meshes != 1) {
            throw InputError("rays", flag, fmt::format("{} meshes", meshes), "one mesh");
        }
    }
    if (!arguments.write_mesh.empty()) {
        check_mesh_name(arguments.write_mesh, "--write-mesh");
        check_output_file(arguments.write_mesh, "--write-mesh");
    }
    if (!arguments.write_rays.empty()) {
        check_output_file(arguments.write_rays, "--write-rays");
    }
    if (!arguments.out.empty()) {
        check_output_file(arguments.out);
        if (stamp_of(arguments.out).exists && !arguments.overwrite) {
            throw InputError("--out", "file", "\"" + arguments.out + "\", which is there",
                             "another name, or --overwrite");
        }
    }
}

// Throws InputError if an output file has been read as input; called again after each mesh is read.
void refuse_sources(const RaysArguments& arguments) {
    refuse_source(arguments.out);
    refuse_source(arguments.write_mesh, "--write-mesh");
    refuse_source(arguments.write_rays, "--write-rays");
}

nlohmann::ordered_json context_of(const RaysArguments& arguments, const rays::RayStudy& study) {
    MachineContext machine = machine_context();
    if (study.backend == Backend::cuda) {
        machine.gpu = cuda::context();
        machine.machine = cuda::machine_name();
    }
    nlohmann::ordered_json context(machine);
    add_fields(context, CallContext{.backend = std::string(to_string(study.backend))});
    add_fields(context, CallContext{.command_line = arguments.command_line, .date = iso_date()});
    return context;
}

// Refuses options about timing beside --leaks, and options about leaks without it.
void check_leak_arguments(const RaysArguments& arguments) {
    if (!arguments.leaks) {
        if (arguments.log2_rays > 26) {
            throw InputError("rays", "--log2-rays", std::to_string(arguments.log2_rays),
                             "4 to 26 (to 40 with --leaks)");
        }
        if (arguments.first_ray != 0 || arguments.seed != 1) {
            throw InputError("rays", arguments.first_ray != 0 ? "--first-ray" : "--seed", "it without --leaks",
                             "it with --leaks");
        }
        return;
    }
    const std::string counters = arguments.counters ? "asked for" : "";
    for (const auto& [flag, text] : {std::pair<const char*, const std::string&>{"--scene", arguments.scenes},
                                     {"--class", arguments.classes},
                                     {"--write-rays", arguments.write_rays},
                                     {"--read-rays", arguments.read_rays},
                                     {"--write-mesh", arguments.write_mesh},
                                     {"--counters", counters}}) {
        if (!text.empty()) {
            throw InputError("rays", flag, "it with --leaks", "one of them");
        }
    }
}

// Searches for leaks, rays that leave a closed mesh; the exit code is 1 if there are any.
int find_leaks(const RaysArguments& arguments) {
    const std::vector<std::string> meshes = names_or_none(arguments.meshes, "--mesh");
    check_arguments(arguments, meshes.size());
    const rays::LeakStudy study{study_of(arguments), arguments.log2_rays, arguments.first_ray, arguments.seed};
    nlohmann::ordered_json context = context_of(arguments, study.trees), measured = nlohmann::ordered_json::array();
    std::uint64_t leaks = 0;
    for (const std::string& name : meshes) {
        const rays::RayMesh mesh = rays::closed_mesh_for_rays(name);
        refuse_sources(arguments);
        fmt::print("{}: {}, closed{}\n", one_line(mesh.name), counted(mesh.triangles.size(), "triangle"),
                   mesh.said.empty() ? "" : ", " + mesh.said);
        std::fflush(stdout);
        rays::LeakResult result = rays::measure_leaks(mesh, study);
        fmt::print("{}", rays::leak_table_of(result.json));
        leaks += result.leaks;
        measured.push_back(std::move(result.json));
    }
    if (!arguments.out.empty()) {
        const nlohmann::ordered_json result{{"schema", "ptbench-leaks-1"},
                                            {"context", std::move(context)},
                                            {"backend", to_string(study.trees.backend)},
                                            {"meshes", std::move(measured)}};
        write_file(arguments.out, result.dump(1) + "\n");
    }
    return leaks == 0 ? exit_good : exit_check_failed;
}

// Calls each(mesh) for every mesh and scene that the command line names.
template <class Each>
void for_each_mesh(const RaysArguments& arguments, const Each& each) {
    for (const std::string& name : names_or_none(arguments.meshes, "--mesh")) {
        each(rays::mesh_for_rays(name));
    }
    for (const std::string& name : names_or_none(arguments.scenes, "--scene")) {
        each(rays::scene_for_rays(name));
    }
}

// The arguments with which ptbench traces the same batches under ncu.
std::vector<std::string> counted_call(const RaysArguments& arguments, const rays::RayStudy& study) {
    std::vector<std::string> call{"--backend", "cuda", "--log2-rays", std::to_string(arguments.log2_rays)};
    for (const auto& [flag, text] : {std::pair<const char*, std::string>{"--mesh", arguments.meshes},
                                     {"--scene", arguments.scenes},
                                     {"--read-rays", arguments.read_rays},
                                     {"--class", fmt::format("{}", fmt::join(study.classes, ","))},
                                     {"--accelerator", fmt::format("{}", fmt::join(study.accelerators, ","))},
                                     {"--builder", fmt::format("{}", fmt::join(study.builders, ","))}}) {
        if (!text.empty()) {
            call.insert(call.end(), {flag, text});
        }
    }
    if (arguments.threads > 0) {
        call.insert(call.end(), {"--threads", std::to_string(arguments.threads)});
    }
    return call;
}

void check_counters(const RaysArguments& arguments, const rays::RayStudy& study) {
    if ((arguments.counters || arguments.counted) && study.backend != Backend::cuda) {
        throw InputError("rays", "--counters", "--backend cpu", "--backend cuda: counters are a GPU's");
    }
    if (arguments.counters) {
        cuda::require_counters();
    }
}

int measure_rays(const RaysArguments& arguments) {
    const std::vector<std::string> meshes = names_or_none(arguments.meshes, "--mesh"),
                                   scenes = names_or_none(arguments.scenes, "--scene");
    check_arguments(arguments, meshes.size() + scenes.size());
    const rays::RayStudy study = study_of(arguments);
    check_counters(arguments, study);
    if (arguments.counted) {
        for_each_mesh(arguments, [&](const rays::RayMesh& mesh) { rays::trace_counted(mesh, study); });
        return exit_good;
    }
    nlohmann::ordered_json context = context_of(arguments, study), measured = nlohmann::ordered_json::array();
    bool agrees = true;
    const auto measure = [&](const rays::RayMesh& mesh) {
        fmt::print("{}: {}{}\n", one_line(mesh.name), counted(mesh.triangles.size(), "triangle"),
                   mesh.said.empty() ? "" : ", " + mesh.said);
        std::fflush(stdout);
        refuse_sources(arguments);
        if (!arguments.write_mesh.empty()) {
            write_mesh(mesh.mesh, arguments.write_mesh);
        }
        rays::MeshResult result = rays::measure(mesh, study);
        fmt::print("{}", rays::table_of(result.json));
        for (const auto& set : result.json["ray_sets"]) {
            if (!set["agree"].get<bool>()) {
                fmt::print("{}: {}: HITS DIFFER between accelerators or from brute force\n", one_line(mesh.name),
                           set["class"].get<std::string>());
            }
        }
        if (!arguments.write_rays.empty()) {
            refuse_sources(arguments);
            rays::write_rays(arguments.write_rays, result.sets, result.hits);
        }
        agrees = agrees && result.agrees;
        measured.push_back(std::move(result.json));
    };
    for_each_mesh(arguments, measure);
    nlohmann::ordered_json ceilings;
    if (arguments.counters) {
        const auto counted = cuda::batch_counters(counted_call(arguments, study), rays::counted_batches(measured));
        rays::add_counters(measured, counted["launches"]);
        ceilings = counted["ceilings"];
        for (const auto& mesh : measured) {
            fmt::print("{}: counters\n{}", one_line(mesh["mesh"].get<std::string>()), rays::counters_table_of(mesh));
        }
    }
    if (!arguments.out.empty()) {
        nlohmann::ordered_json result{{"schema", "ptbench-rays-1"},          {"context", std::move(context)},
                                      {"backend", to_string(study.backend)}, {"threads", omp_get_max_threads()},
                                      {"repetitions", study.repetitions},    {"meshes", std::move(measured)}};
        if (!ceilings.is_null()) {
            result["ceilings"] = ceilings;
        }
        write_file(arguments.out, result.dump(1) + "\n");
    }
    return agrees ? exit_good : exit_check_failed;
}

// Runs `ptbench rays`; errors of the device become MachineError.
int run_rays(const RaysArguments& arguments) {
    try {
        check_leak_arguments(arguments);
        if (arguments.threads > 0) {
            omp_set_num_threads(arguments.threads);
        }
        return arguments.leaks ? find_leaks(arguments) : measure_rays(arguments);
    } catch (const InputError&) {
        throw;
    } catch (const MachineError&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw MachineError(error.what());
    }
}

}  // namespace

Command add_rays_command(CLI::App& app, const std::string& command_line) {
    auto arguments = std::make_shared<RaysArguments>();
    arguments->command_line = command_line;
    CLI::App* command = app.add_subcommand("rays", "Rates of ray batches without shading, by accelerator and builder");
    const auto add_text = [&](const char* name, std::string& value, const char* what) {
        return command->add_option(name, value, what)->check(check_not_empty);
    };
    add_text("--mesh", arguments->meshes,
             "Meshes, comma-separated: NAME:SIZE of `ptbench generate` (in a box), a file (.ply, .obj, .glb), or "
             "sphere_262k, sphere_2M, sphere_8M, tori_262k, tori_4M");
    add_text("--scene", arguments->scenes, "Scenes, comma-separated: their meshes, seen by their cameras");
    add_text("--class", arguments->classes,
             "primary, ambient_occlusion, shadow, diffuse_1, diffuse_3, random, comma-separated (default: all)");
    add_text("--accelerator", arguments->accelerators,
             "Choices of the axis, comma-separated (default: those whose trees are made by the axis builder)");
    add_text("--builder", arguments->builders, "Choices of the axis, comma-separated (default: sah_binned)");
    command->add_option("--backend", arguments->backend, "cpu or cuda (default: cuda where it is available)");
    command->add_option("--log2-rays", arguments->log2_rays, "2^N rays a class (default 20); of --leaks, in all")
        ->check(CLI::Range(std::uint32_t{4}, std::uint32_t{40}));
    command->add_flag("--leaks", arguments->leaks,
                      "Instead: rays from within closed meshes at their vertices and edges; exit code 1 if one leaves. "
                      "Meshes have no box here");
    command->add_option("--first-ray", arguments->first_ray, "Of --leaks: the number of the first ray (default 0)");
    command->add_option("--seed", arguments->seed, "Of --leaks: seed (default 1)")->check(check_seed);
    command
        ->add_option("--repetitions", arguments->repetitions, "Times that each batch is traced and timed (default 9)")
        ->check(CLI::Range(1, 1000));
    command->add_option("--check", arguments->checked, "Rays of each class that are held to brute force (default 1024)")
        ->check(CLI::Range(std::uint32_t{0}, std::uint32_t{1} << 20));
    command->add_option("--threads", arguments->threads, "Threads of the CPU (default: all)")
        ->check(CLI::Range(1, 4096));
    add_text("--write-rays", arguments->write_rays, "Write the rays of the one mesh into this file");
    add_text("--read-rays", arguments->read_rays, "Trace the rays of this file instead");
    add_text("--write-mesh", arguments->write_mesh, "Write the one mesh as it is traced (.ply or .obj)");
    add_text("--out", arguments->out, "Result file (JSON); none: print only");
    command->add_flag("--counters", arguments->counters,
                      "Also trace each batch once under ncu: active lanes, instructions and bytes a ray, issue, caches "
                      "and memory as fractions of their ceilings");
    command->add_flag("--counted", arguments->counted, "What --counters runs under ncu")->group("");
    command->add_flag("--overwrite", arguments->overwrite, "Replace a result that is there");
    return [arguments] { return run_rays(*arguments); };
}

}  // namespace pt
