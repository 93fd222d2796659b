// Queues made by hand, for tests of what compactions and sorts do to them on the CPU.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

#include "tests/support/statistics.h"
#include "variants/registry.h"

namespace pt::test {

inline constexpr std::size_t queue_sizes[] = {0, 1, 2, 3, 1023, 1024, 1025, 4095, 4096, 4097, 100000};

// Every scalar of a path, bit for bit. There is no padding to skip.
using PathBits = std::array<std::uint32_t, 20>;
static_assert(sizeof(PathBits) == sizeof(Path<float>));
inline PathBits bits_of(const Path<float>& path) { return std::bit_cast<PathBits>(path); }

inline Path<float> random_path(Random& random, std::uint32_t id, bool alive) {
    const auto vector = [&] {
        return Vec3<float>{static_cast<float>(random.uniform(-1, 1)), static_cast<float>(random.uniform(-1, 1)),
                           static_cast<float>(random.uniform(-1, 1))};
    };
    Path<float> path{};
    path.origin = vector();
    path.direction = vector();
    path.throughput = vector();
    path.radiance = vector();
    path.time = static_cast<float>(random.uniform());
    path.bsdf_pdf = static_cast<float>(random.uniform());
    path.pixel = id;
    path.sample = random.word();
    path.segment = alive ? id % 7 : Path<float>::ended;
    path.origin_surface = SurfaceId{random.word()};
    path.medium = random.word();
    path.primitive = random.word();
    return path;
}

enum class Pattern { all, none, random, rare, first_only, last_only, alternating };
inline constexpr Pattern patterns[] = {Pattern::all,        Pattern::none,      Pattern::random,     Pattern::rare,
                                       Pattern::first_only, Pattern::last_only, Pattern::alternating};

inline bool is_alive(Pattern pattern, std::size_t i, std::size_t count, Random& random) {
    switch (pattern) {
        case Pattern::all:
            return true;
        case Pattern::none:
            return false;
        case Pattern::random:
            return random.uniform() < 0.5;
        case Pattern::rare:
            return random.uniform() < 0.01;
        case Pattern::first_only:
            return i == 0;
        case Pattern::last_only:
            return i + 1 == count;
        default:
            return i % 2 == 0;
    }
}

// A queue of paths that are told apart by `pixel`, each with a hit that says whose it is, and a copy of what was put
// in.
struct HandMadeQueue {
    PathQueue queue;
    std::vector<Path<float>> paths;  // as put in, by slot

    HandMadeQueue(const std::string& layout, std::size_t count, Pattern pattern, std::uint64_t seed) {
        queue.paths = Registry::instance().find("layout", layout)->hook.layout();
        queue.reserve(count + 5);  // a queue is as large as the largest render so far
        queue.count = count;
        Random random(seed);
        for (std::size_t i = 0; i < count; ++i) {
            const bool alive = is_alive(pattern, i, count, random);
            paths.push_back(random_path(random, static_cast<std::uint32_t>(i), alive));
            std::visit([&](auto& stored) { stored.store(i, paths[i]); }, queue.paths);
            queue.hits[i] = {static_cast<float>(i), SurfaceId{static_cast<std::uint32_t>(i)}};
        }
    }

    Path<float> load(std::size_t slot) const {
        return std::visit([&](const auto& stored) { return stored.load(slot); }, queue.paths);
    }
    // The ids of the paths in play, in their order.
    std::vector<std::uint32_t> ids_in_play() const {
        std::vector<std::uint32_t> ids;
        for (std::size_t i = 0; i < queue.count; ++i) {
            ids.push_back(load(queue.slot(i)).pixel);
        }
        return ids;
    }
    // The ids of the paths in slots [first, last).
    std::vector<std::uint32_t> ids_in_slots(std::size_t first, std::size_t last) const {
        std::vector<std::uint32_t> ids;
        for (std::size_t slot = first; slot < last; ++slot) {
            ids.push_back(load(slot).pixel);
        }
        return ids;
    }
    std::vector<std::uint32_t> ids_where(bool alive) const {
        std::vector<std::uint32_t> ids;
        for (const Path<float>& path : paths) {
            if (path.alive() == alive) {
                ids.push_back(path.pixel);
            }
        }
        return ids;
    }
    // Every path in slots [0, last) is one of those that were put in, with no field changed.
    bool payload_is_intact(std::size_t last) const {
        for (std::size_t slot = 0; slot < last; ++slot) {
            const Path<float> path = load(slot);
            if (path.pixel >= paths.size() || bits_of(path) != bits_of(paths[path.pixel])) {
                return false;
            }
        }
        return true;
    }
    bool payload_is_in_place() const {
        for (std::size_t slot = 0; slot < paths.size(); ++slot) {
            if (bits_of(load(slot)) != bits_of(paths[slot]) || queue.hits[slot].side.code != slot) {
                return false;
            }
        }
        return true;
    }
    // Ends some of the paths in play, as a bounce does.
    void end_every_third() {
        for (std::size_t i = 0; i < queue.count; i += 3) {
            const std::uint32_t slot = queue.slot(i);
            Path<float> path = load(slot);
            path.segment = Path<float>::ended;
            std::visit([&](auto& stored) { stored.store(slot, path); }, queue.paths);
            paths[path.pixel].segment = Path<float>::ended;
        }
    }
};

inline std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> ids) {
    std::sort(ids.begin(), ids.end());
    return ids;
}

}  // namespace pt::test
