// `ptbench new`: writes working starter files for a choice, a shape or a material, from harness/templates/KIND.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/commands.h"
#include "harness/json_reader.h"
#include "harness/scene/places.h"
#include "harness/write_file.h"
#include "kernels/scene_arrays.h"
#include "variants/registry.h"

namespace pt {

namespace {

namespace fs = std::filesystem;

struct TemplateFile {
    std::string_view source;   // path of the template in harness/templates/KIND
    std::string_view written;  // path of the written file in the repository
    std::string_view what;
};

// Placeholders in a template's path and text: "@NAME@" for the name, "@TYPE@" for the class of a shape or material.
constexpr std::string_view name_placeholder = "@NAME@";
constexpr std::string_view type_placeholder = "@TYPE@";

constexpr TemplateFile compaction_files[] = {
    {"choice.cpp.in", "variants/compaction/@NAME@.cpp", "the CPU's side"},
    {"choice.cuh.in", "variants/compaction/@NAME@.cuh", "CUDA's side: the kernel and what launches it"},
    {"test.cpp.in", "tests/unit/@NAME@_compaction_test.cpp", "its test"},
};
constexpr TemplateFile integrator_files[] = {
    {"choice.h.in", "variants/integrator/@NAME@.h", "the CPU's side"},
    {"choice.cuh.in", "variants/integrator/@NAME@.cuh", "CUDA's side: the kernel and what launches it"},
    {"test.cpp.in", "tests/unit/@NAME@_integrator_test.cpp", "its test"},
};
constexpr TemplateFile shape_files[] = {
    {"shape.h.in", "kernels/shapes/@NAME@.h", "the shape"},
    {"test.cpp.in", "tests/unit/@NAME@_shape_test.cpp", "its test"},
};
constexpr TemplateFile material_files[] = {
    {"material.h.in", "kernels/materials/@NAME@.h", "the material in kernels"},
    {"kind.cpp.in", "harness/scene/materials/@NAME@.cpp", "the material in scene files"},
    {"test.cpp.in", "tests/unit/@NAME@_material_test.cpp", "its test"},
};

// A macro list in a source file with one line for each shape or material.
struct ListOf {
    std::string_view file;
    std::string_view end_of_lines;  // text in the file at which the macro list ends
    std::string_view line;          // format of a list line; {0}: name, {1}: class, {2}: name in capitals
    std::string_view example;       // an example of a list line, for error messages
};
constexpr ListOf shape_list{"kernels/shape_list.h", ", more)\n\n", "SHAPE({0}, {0}s, {1}, {2}S, more)",
                            "SHAPE(..., more)"};
constexpr ListOf material_list{"kernels/material_list.h", ")\n\n#define PT_MATERIAL_TYPE",
                               "MATERIAL({0}, {1}, is_delta)", "MATERIAL(...)"};

// A kind of files that `ptbench new` writes.
struct Kind {
    std::string_view name;  // name of the kind and of its folder of templates
    std::span<const TemplateFile> files;
    std::string_view folder;  // folder in which `ptbench new` writes files of this kind
    std::string_view next;    // next steps to print for the user; {0}: the repository, {1}: the name
    const ListOf* list = nullptr;
};
constexpr Kind kinds[] = {
    {"compaction", compaction_files, "variants/compaction",
     "  ./run build {1}_compaction_test && build/tests/{1}_compaction_test\n"
     "  build/ptbench verify --scene cornell_open --axis compaction={1} --quiet\n"
     "  build/ptbench inspect --scene cornell_open --axis compaction={1} --arch sm_90, which compiles its CUDA kernels "
     "without a GPU\n"
     "  build/ptbench run --scene cornell_open,cornell_closed --axis compaction=none,{1}\n"},
    {"integrator", integrator_files, "variants/integrator",
     "  ./run build {1}_integrator_test && build/tests/{1}_integrator_test\n"
     "  build/ptbench verify --scene cornell_open --axis integrator={1} --quiet\n"
     "  build/ptbench inspect --scene cornell_open --axis integrator={1} --arch sm_90, which compiles its CUDA kernels "
     "without a GPU\n"
     "  build/ptbench run --scene cornell_open,cornell_closed --axis integrator=wavefront,{1}\n"},
    {"shape", shape_files, "kernels/shapes",
     "  ./run build {1}_shape_test && build/tests/{1}_shape_test\n"
     "  build/ptbench verify --scene my_scene.json --quiet, of a scene with {{\"shape\": \"{1}\", ...}}\n",
     &shape_list},
    {"material", material_files, "kernels/materials",
     "  ./run build {1}_material_test && build/tests/{1}_material_test\n"
     "  build/ptbench verify --scene my_scene.json --quiet, of a scene with {{\"type\": \"{1}\", ...}}\n",
     &material_list},
};

struct NewFile {
    fs::path path;
    std::string text;
    std::string_view what;
    std::optional<std::string> before;  // content of the file before `ptbench new`; none for a new file
};

std::string replaced(std::string text, std::string_view placeholder, std::string_view value) {
    for (std::size_t at = text.find(placeholder); at != std::string::npos; at = text.find(placeholder, at)) {
        text.replace(at, placeholder.size(), value);
        at += value.size();
    }
    return text;
}

// The class name of a new shape or material, e.g. MyBallShape for a shape my_ball.
std::string type_of(const std::string& name, const Kind& kind) {
    std::string type;
    bool begins = true;
    for (const char c : name + "_" + std::string(kind.name)) {
        if (c != '_') {
            type += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        }
        begins = c == '_';
    }
    return type;
}

std::string with_name(std::string_view text, const std::string& name, const Kind& kind) {
    return replaced(replaced(std::string(text), name_placeholder, name), type_placeholder, type_of(name, kind));
}

// The macro list of the kind with one more line at the end.
std::string with_line(const std::string& list, const std::string& name, const Kind& kind) {
    const std::size_t end = list.find(kind.list->end_of_lines);
    if (end == std::string::npos) {
        throw InputError("new", "file", std::string(kind.list->file),
                         fmt::format("a list of lines {}", kind.list->example));
    }
    const std::size_t after = end + kind.list->end_of_lines.find('\n');
    const std::size_t line = list.rfind('\n', end) + 1;
    const std::size_t line_before = list.rfind('\n', line - 2) + 1;
    // The backslashes of all lines of a macro list but the last are aligned in one column.
    const std::size_t column = list.find('\\', line_before) - line_before;
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return list.substr(0, after) + std::string(column > after - line ? column - (after - line) : 1, ' ') + "\\\n    " +
           fmt::format(fmt::runtime(kind.list->line), name, type_of(name, kind), upper) + list.substr(after);
}

// Names that are reserved in C++ or on the command line, or would hide names that the written files use.
constexpr std::string_view reserved_names[] = {
    "alignas",       "alignof",     "all",       "and",       "and_eq",       "asm",
    "auto",          "bitand",      "bitor",     "bool",      "break",        "case",
    "catch",         "char",        "char16_t",  "char32_t",  "char8_t",      "class",
    "co_await",      "co_return",   "co_yield",  "compl",     "concept",      "const",
    "const_cast",    "consteval",   "constexpr", "constinit", "continue",     "decltype",
    "default",       "delete",      "do",        "double",    "dynamic_cast", "else",
    "enum",          "errno",       "explicit",  "export",    "extern",       "false",
    "float",         "for",         "friend",    "goto",      "if",           "inline",
    "int",           "long",        "mutable",   "namespace", "new",          "noexcept",
    "not",           "not_eq",      "nullptr",   "on_cuda",   "operator",     "or",
    "or_eq",         "private",     "protected", "public",    "register",     "reinterpret_cast",
    "requires",      "return",      "short",     "signed",    "sizeof",       "static",
    "static_assert", "static_cast", "std",       "stderr",    "stdin",        "stdout",
    "struct",        "switch",      "template",  "this",      "thread_local", "throw",
    "true",          "try",         "typedef",   "typeid",    "typename",     "union",
    "unsigned",      "using",       "virtual",   "void",      "volatile",     "wchar_t",
    "while",         "xor",         "xor_eq"};

constexpr std::size_t longest_name = 32;  // limits the length of variants' names, which contain the choice's name

// Whether a name is snake_case: lower case letters and digits, joined by single underscores, starting with a letter.
bool is_snake_case(const std::string& name) {
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyz0123456789_";
    return !name.empty() && name.front() >= 'a' && name.front() <= 'z' && name.back() != '_' &&
           name.find_first_not_of(allowed) == std::string::npos && name.find("__") == std::string::npos;
}

void check_name(const std::string& name) {
    if (!is_snake_case(name) || name.size() > longest_name) {
        throw InputError("new", "NAME", "\"" + name + "\"",
                         fmt::format("lower_snake_case of at most {} characters, e.g. my_scan", longest_name));
    }
    if (std::find(std::begin(reserved_names), std::end(reserved_names), name) != std::end(reserved_names)) {
        throw InputError("new", "NAME", "\"" + name + "\"", "a name that is no word of C++ or of ptbench");
    }
}

// A file in the folder or its subfolders with this name before the first dot; empty if there is none.
fs::path file_named(const fs::path& folder, const std::string& name) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        const std::string found = entry.path().filename().string();
        if (found.substr(0, found.find('.')) == name) {
            return entry.path();
        }
    }
    return {};
}

[[noreturn]] void refuse_taken(const std::string& name, const std::string& by) {
    throw InputError("new", "NAME", "\"" + name + "\"", "a name that is not taken: " + by);
}

// A shape's or material's name becomes a feature name, which must be unused.
void check_feature_is_free(const std::string& name) {
    const std::vector<std::string> features = feature_names(~FeatureSet{0});
    if (std::find(features.begin(), features.end(), name) != features.end()) {
        refuse_taken(name, name + " is a feature of kernels");
    }
}

// A shape's name with an s becomes the name of an array in SceneView, which must be unused.
void check_array_is_free(const std::string& name) {
    SceneView<float> view{};
    for_each_array(view, [&](const SceneArray& array, const auto&) {
        if (array.name == name + "s") {
            refuse_taken(name, fmt::format("{}s is an array of scenes", name));
        }
    });
}

void check_is_free(const fs::path& home, const Kind& kind, const std::string& name) {
    const std::string axis(kind.name);
    for (const Backend backend : all_backends) {
        if (Registry::instance().find(axis, name, backend) != nullptr) {
            refuse_taken(name, fmt::format("{} is a choice of {} (see ptbench list)", name, axis));
        }
    }
    if (kind.list != nullptr) {
        check_feature_is_free(name);
    }
    if (kind.name == "shape") {
        check_array_is_free(name);
    }
    for (const auto& [folder, stem] :
         {std::pair{home / kind.folder, name}, std::pair{home / "tests", fmt::format("{}_{}_test", name, axis)}}) {
        if (const fs::path taken = file_named(folder, stem); !taken.empty()) {
            refuse_taken(name, fmt::format("there is a file {}", taken.string()));
        }
    }
}

// Returns the files that `ptbench new` would write, with their contents, and writes nothing.
std::vector<NewFile> new_files(const fs::path& home, const Kind& kind, const std::string& name) {
    std::vector<NewFile> files;
    for (const TemplateFile& file : kind.files) {
        const std::string text = read_file((home / "harness/templates" / kind.name / file.source).string());
        files.push_back(
            {home / with_name(file.written, name, kind), with_name(text, name, kind), file.what, std::nullopt});
    }
    if (kind.list != nullptr) {
        const fs::path path = home / kind.list->file;
        const std::string list = read_file(path.string());
        files.push_back({path, with_line(list, name, kind), "its line in the list", list});
    }
    return files;
}

// Writes all files of `ptbench new`: if one fails, those written are removed. An existing file is replaced last.
void write_all(const std::vector<NewFile>& files) {
    std::size_t written = 0;
    try {
        for (const NewFile& file : files) {
            write_file(file.path.string(), file.text);
            written += 1;
        }
    } catch (const MachineError&) {
        std::error_code ignored;
        for (std::size_t i = 0; i < written; ++i) {
            if (!files[i].before) {
                fs::remove(files[i].path, ignored);
            }
        }
        throw;
    }
}

int run(const std::string& kind_name, const std::string& name) {
    const auto* const kind =
        std::find_if(std::begin(kinds), std::end(kinds), [&](const Kind& known) { return known.name == kind_name; });
    if (kind == std::end(kinds)) {
        throw InputError("new", "KIND", "\"" + kind_name + "\"", fmt::format("{}", fmt::join(kinds_of_new(), ", ")));
    }
    check_name(name);
    const fs::path home = home_folder();
    for (const fs::path& folder :
         {fs::path("harness/templates") / kind->name, fs::path(kind->folder), fs::path("tests/unit")}) {
        if (!fs::is_directory(home / folder)) {
            throw InputError("new", "folder", fmt::format("no {} in {}", folder.string(), home.string()),
                             "a checkout of the repository (a package has no sources that a choice could be added to)");
        }
    }
    check_is_free(home, *kind, name);
    const std::vector<NewFile> files = new_files(home, *kind, name);
    write_all(files);
    for (const NewFile& file : files) {
        fmt::print("{}  {}\n", file.path.string(), file.what);
    }
    fmt::print("Next, in {}:\n{}", home.string(), fmt::format(fmt::runtime(kind->next), home.string(), name));
    return exit_good;
}

}  // namespace

std::vector<std::string> kinds_of_new() {
    std::vector<std::string> names;
    for (const Kind& kind : kinds) {
        names.emplace_back(kind.name);
    }
    return names;
}

Command add_new_command(CLI::App& app) {
    struct NewArguments {
        std::string kind;
        std::string name;
    };
    auto arguments = std::make_shared<NewArguments>();
    CLI::App* command =
        app.add_subcommand("new", "Write the starting files of a choice, shape or material of your own, with its test");
    command->add_option("KIND", arguments->kind, "What is new: a compaction, an integrator, a shape or a material")
        ->required();
    command->add_option("NAME", arguments->name, "Its name, in lower_snake_case")->required();
    return [arguments] { return run(arguments->kind, arguments->name); };
}

}  // namespace pt
