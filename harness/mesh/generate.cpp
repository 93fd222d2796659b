#include "harness/mesh/generate.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/generators.h"
#include "harness/nearest_name.h"

namespace pt {

namespace {

std::uint64_t nothing(std::uint32_t) { return 0; }
std::uint64_t power(std::uint64_t base, std::uint32_t exponent) {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}
std::uint64_t square(std::uint64_t n) { return n * n; }
std::uint64_t same(std::uint32_t n) { return n; }
std::uint64_t teapot_triangles(std::uint32_t n) { return 64 * square(n) - 8 * std::uint64_t{n}; }

const Generator table[] = {
    {"icosphere", "sphere of an icosahedron, with smooth bumps", "levels of division", "20 x 4^N", 0, 10,
     [](std::uint32_t n) { return 20 * power(4, n); }, nothing, true, true, make_icosphere},
    {"grid_sphere", "sphere of a grid in latitude and longitude, with fine bumps", "rows of latitude", "4 N^2 - 4 N", 3,
     4096, [](std::uint32_t n) { return 4 * (square(n) - n); }, [](std::uint32_t n) { return std::uint64_t{4} * n; },
     true, true, make_probe_sphere},
    {"menger", "Menger sponge, its outer faces", "levels of boring", "4 x 20^N + 8 x 8^N", 0, 5,
     [](std::uint32_t n) { return 2 * (2 * power(20, n) + 4 * power(8, n)); }, nothing, true, false,
     make_menger_sponge},
    {"teapot", "Newell's 32 patches, 6.525 long", "pieces of a patch's side", "64 N^2 - 8 N", 2, 1024, teapot_triangles,
     [](std::uint32_t n) { return std::uint64_t{8} * n; }, false, true, make_teapot},
    {"stadium", "the teapot on a quad 10^5 times as long", "as the teapot's", "64 N^2 - 8 N + 2", 2, 1024,
     [](std::uint32_t n) { return teapot_triangles(n) + 2; }, [](std::uint32_t n) { return std::uint64_t{8} * n; },
     false, true, make_stadium},
    {"hairball", "bent tubes of 24 x 6 sides outward from the centre", "hairs", "288 N", 1, 400'000,
     [](std::uint32_t n) { return std::uint64_t{288} * n; }, nothing, false, true, make_hairball},
    {"trefoil", "tube along a trefoil knot, 8 N rings of N corners", "corners of a ring", "16 N^2", 3, 2048,
     [](std::uint32_t n) { return 16 * square(n); }, nothing, true, true, make_trefoil},
    {"tori", "tori of 64 x 32 quads at random", "tori", "4096 N", 1, 32'768,
     [](std::uint32_t n) { return std::uint64_t{4096} * n; }, nothing, true, true, make_tori},
    {"needles", "triangles 2^7 to 2^13 times longer than wide, at random", "triangles", "N", 1, 1u << 24, same, nothing,
     false, false, make_needles},
    {"equal", "the same triangle N times", "triangles", "N", 1, 1u << 24, same, nothing, false, false,
     make_equal_triangles},
    {"terrain", "height field of fractal noise over 2^N x 2^N cells", "levels of noise", "2 x 4^N", 1, 12,
     [](std::uint32_t n) { return 2 * power(4, n); }, nothing, false, true, make_terrain},
    {"cornell", "Cornell box, open at the front, with its two blocks", "pieces of a quad's side", "30 N^2", 1, 2048,
     [](std::uint32_t n) { return 30 * square(n); }, nothing, false, false, make_cornell_box},
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
