// The names that the command line accepts, for `ptbench list --names` and for completion.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "variants/descriptor.h"

namespace pt {

// The names of the choices of an axis on any of the backends, baselines first.
std::vector<std::string> names_of_choices(std::string_view axis, BackendSet backends = on_every_backend);
std::vector<std::string> names_of_axes();
std::vector<std::string> names_of_tunables();
std::vector<std::string> names_of_commands(const CLI::App& app);

// The kinds of names that `list --names` accepts besides names of axes.
inline const std::vector<std::string> kinds_of_names{"axes", "scenes", "suites", "tunables", "backends", "commands"};
// The names of a kind, or the choices of the axis with that name. Throws InputError for any other name.
std::vector<std::string> known_names(const std::string& kind_or_axis, const CLI::App& app);

}  // namespace pt
