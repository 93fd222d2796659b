#include "harness/mesh/generate.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/error.h"
#include "harness/mesh/generators.h"
#include "harness/nearest_name.h"

namespace pt {

namespace {

std::uint64_t nothing(std::uint32_t) { return 0; }
std::uint64_t power(std::uint64_t base, std::uint32_t exponent) {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}
std::uint64_t square(std::uint64_t n) { return n * n; }

const Generator table[] = {
    {"icosphere", "sphere of an icosahedron, with smooth bumps; 20 x 4^N triangles", "level of division", 0, 10,
     [](std::uint32_t n) { return 20 * power(4, n); }, nothing, true, make_icosphere},
    {"grid_sphere", "sphere of N rows of latitude by 2 N of longitude, with fine bumps; 4 N (N - 1)", "rows", 3, 4096,
     [](std::uint32_t n) { return 4 * square(n) - 4 * n; }, [](std::uint32_t n) { return std::uint64_t{4} * n; }, true,
     make_probe_sphere},
};

}  // namespace

std::span<const Generator> generators() { return table; }

const Generator* find_generator(std::string_view name) {
    const auto found =
        std::find_if(std::begin(table), std::end(table), [&](const auto& one) { return one.name == name; });
    return found == std::end(table) ? nullptr : &*found;
}

Mesh generate_mesh(std::string_view name, std::uint32_t size) {
    const Generator* generator = find_generator(name);
    if (generator == nullptr) {
        std::vector<std::string> names;
        for (const Generator& one : table) {
            names.emplace_back(one.name);
        }
        throw InputError(fmt::format("mesh generator: found \"{}\"{}, allowed: {}", name, did_you_mean(name, names),
                                     fmt::join(names, ", ")));
    }
    if (size < generator->least_size || size > generator->most_size) {
        throw InputError(fmt::format("mesh {}: size ({}): found {}, allowed: {} to {}", name, generator->size, size,
                                     generator->least_size, generator->most_size));
    }
    return generator->make(size);
}

}  // namespace pt
