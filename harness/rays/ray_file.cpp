#include "harness/rays/ray_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/json_reader.h"
#include "harness/write_file.h"

namespace pt::rays {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Ray) == 32);
constexpr char magic[] = "PTBRAYS1";
constexpr std::uint64_t largest_ray_file = std::uint64_t{1} << 33;
constexpr std::uint64_t most_rays = std::uint64_t{1} << 27;

struct SetHeader {
    char name[24] = {};
    std::uint32_t any = 0, unused = 0;
    std::uint64_t count = 0, hits = 0;
};
static_assert(sizeof(SetHeader) == 48);

class Reader {
public:
    Reader(const std::string& content, const std::string& file) : content_(content), file_(file) {}

    void read(void* into, std::size_t bytes, const char* what) {
        if (content_.size() - at_ < bytes) {
            throw InputError(file_, fmt::format("byte {}", at_), fmt::format("{} bytes left", content_.size() - at_),
                             fmt::format("{} of {}", bytes, what));
        }
        std::memcpy(into, content_.data() + at_, bytes);
        at_ += bytes;
    }
    std::size_t left() const { return content_.size() - at_; }

private:
    const std::string& content_;
    const std::string& file_;
    std::size_t at_ = 0;
};

bool is_ray(const Ray& ray) {
    bool good = ray.t_max > 0.0f, moves = false;
    for (int k = 0; k < 3; ++k) {
        good = good && std::isfinite(ray.origin[k]) && std::isfinite(ray.direction[k]);
        moves = moves || ray.direction[k] != 0.0f;
    }
    return good && moves;
}

}  // namespace

void write_rays(const std::string& file, const std::vector<RaySet>& sets, const std::vector<std::uint64_t>& hits) {
    std::string content(magic, 8);
    const std::uint32_t counts[2] = {static_cast<std::uint32_t>(sets.size()), 0};
    content.append(reinterpret_cast<const char*>(counts), sizeof counts);
    for (std::size_t i = 0; i < sets.size(); ++i) {
        SetHeader header;
        sets[i].name.copy(header.name, sizeof header.name - 1);
        header.any = sets[i].any ? 1 : 0;
        header.count = sets[i].rays.size();
        header.hits = hits[i];
        content.append(reinterpret_cast<const char*>(&header), sizeof header);
        content.append(reinterpret_cast<const char*>(sets[i].rays.data()), sets[i].rays.size() * sizeof(Ray));
    }
    write_file(file, content);
}

std::vector<RaySet> read_rays(const std::string& file, std::vector<std::uint64_t>* hits) {
    const std::string content = read_file(file, largest_ray_file);
    Reader reader(content, file);
    char found[8];
    reader.read(found, sizeof found, "the file's kind");
    if (std::memcmp(found, magic, sizeof found) != 0) {
        throw InputError(file, "byte 0", "another kind of file", "PTBRAYS1, as `ptbench rays --write-rays` writes it");
    }
    std::uint32_t counts[2];
    reader.read(counts, sizeof counts, "the number of sets");
    if (counts[0] == 0 || counts[0] > 1000) {
        throw InputError(file, "number of sets", std::to_string(counts[0]), "1 to 1000");
    }
    std::vector<RaySet> sets;
    for (std::uint32_t i = 0; i < counts[0]; ++i) {
        SetHeader header;
        reader.read(&header, sizeof header, "a set's head");
        header.name[sizeof header.name - 1] = '\0';
        if (header.count == 0 || header.count > most_rays) {
            throw InputError(file, fmt::format("set {}: number of rays", i), std::to_string(header.count), "1 to 2^27");
        }
        if (reader.left() / sizeof(Ray) < header.count) {
            throw InputError(file, fmt::format("set {}", i), fmt::format("{} whole rays", reader.left() / sizeof(Ray)),
                             fmt::format("{} as its head says", header.count));
        }
        RaySet set{header.name, header.any != 0, std::vector<Ray>(header.count)};
        reader.read(set.rays.data(), header.count * sizeof(Ray), "rays");
        for (std::size_t k = 0; k < set.rays.size(); ++k) {
            if (!is_ray(set.rays[k])) {
                throw InputError(file, fmt::format("set {}, ray {}", i, k), "no ray",
                                 "finite numbers, a direction that is not 0, t_max above 0");
            }
        }
        sets.push_back(std::move(set));
        if (hits != nullptr) {
            hits->push_back(header.hits);
        }
    }
    if (reader.left() != 0) {
        throw InputError(file, "end", fmt::format("{} bytes after the last set", reader.left()), "none");
    }
    return sets;
}

}  // namespace pt::rays
