#pragma once
#include <string>
namespace pt {
std::string import_seed_scene(const std::string& text, const std::string& file);
}
