// The names that the command line takes, for `ptbench list --names` and for the completion of what is typed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "variants/descriptor.h"

namespace pt {

// The names of an axis's choices on any of the backends, baselines first.
std::vector<std::string> names_of_choices(std::string_view axis, BackendSet backends = on_every_backend);
std::vector<std::string> names_of_axes();
std::vector<std::string> names_of_tunables();
std::vector<std::string> names_of_commands(const CLI::App& app);

// What `list --names` lists besides the choices of an axis.
inline const std::vector<std::string> kinds_of_names{"axes", "scenes", "suites", "tunables", "backends", "commands"};
// The names of one of the kinds, or the choices of the axis of that name. Throws InputError for another name.
std::vector<std::string> known_names(const std::string& kind_or_axis, const CLI::App& app);

}  // namespace pt
