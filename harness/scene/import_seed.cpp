#include "harness/scene/import_seed.h"
#include "harness/error.h"
namespace pt {
std::string import_seed_scene(const std::string&, const std::string& file) {
    throw InputError(file + ": import is being written");
}
}
