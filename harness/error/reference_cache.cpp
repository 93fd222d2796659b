#include "harness/error/reference_cache.h"

#include <bit>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/machine/machine.h"
#include "harness/write_file.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

static_assert(std::endian::native == std::endian::little);

// The identity of a cached reference; a cache file is used only if the identity stored in it is equal.
Json identity_of(const Reference& reference) {
    return {{"format", 1},
            {"scene", reference.scene},
            {"scene_hash", reference.scene_hash},
            {"resolution", {reference.width, reference.height}},
            {"depth", reference.depth},
            {"variant", reference.variant_id},
            {"backend", reference.backend},
            {"seeds", {reference.seeds[0], reference.seeds[1]}},
            {"sources", image_sources_hash()}};
}

std::string bytes_of(const Image& first, const Image& second) {
    std::string bytes(reinterpret_cast<const char*>(first.data()), first.size() * sizeof(double));
    return bytes.append(reinterpret_cast<const char*>(second.data()), second.size() * sizeof(double));
}

std::string hash_of(const std::string& bytes) { return fmt::format("{:016x}", fnv1a(bytes)); }

// Reads a reference from the cache. Throws std::runtime_error if the file is damaged or of another reference.
void read_into(Reference& reference, const std::string& stem) {
    const Json json = parse_json(read_file(stem + ".json"), stem + ".json");
    const Json expected = identity_of(reference);
    if (!json.is_object() || json.value("identity", Json()) != expected) {
        throw std::runtime_error("it is of something else");
    }
    const std::string bytes = read_file(stem + ".f64", std::uint64_t{4} << 30);
    const std::size_t values = std::size_t{3} * reference.width * reference.height;
    if (bytes.size() != 2 * values * sizeof(double) || json.value("hash", "") != hash_of(bytes)) {
        throw std::runtime_error("its numbers are not those that were written");
    }
    const Json spp = json.value("spp_per_half", Json());
    if (!spp.is_number_unsigned() || spp == 0u) {
        throw std::runtime_error("it does not say its samples");
    }
    reference.first.resize(values);
    reference.second.resize(values);
    std::memcpy(reference.first.data(), bytes.data(), values * sizeof(double));
    std::memcpy(reference.second.data(), bytes.data() + values * sizeof(double), values * sizeof(double));
    reference.spp_per_half = spp;
    reference.git_sha = json.value("git_sha", "");
}

}  // namespace

std::string ReferenceCache::stem(const Reference& reference) const {
    const std::string key = identity_of(reference).dump();
    return (std::filesystem::path(folder_) / fmt::format("{}_{}x{}_{}_{:016x}", reference.scene, reference.width,
                                                         reference.height, reference.depth, fnv1a(key)))
        .string();
}

bool ReferenceCache::load(Reference& reference) const {
    const std::string file = stem(reference);
    std::error_code ignored;
    if (folder_.empty() || !std::filesystem::exists(file + ".json", ignored)) {
        return false;
    }
    try {
        read_into(reference, file);
        return true;
    } catch (const std::exception& exception) {
        says_(fmt::format("{}.json: refused and made again: {}", file, exception.what()));
        return false;
    }
}

void ReferenceCache::store(const Reference& reference) const {
    if (folder_.empty()) {
        return;
    }
    const std::string file = stem(reference);
    const std::string bytes = bytes_of(reference.first, reference.second);
    Json json = reference.provenance();
    json["identity"] = identity_of(reference);
    json["hash"] = hash_of(bytes);
    try {
        write_file(file + ".f64", bytes);
        write_file(file + ".json", json.dump(1) + "\n");
    } catch (const MachineError& error) {
        says_(fmt::format("the reference is not kept: {}", error.what()));
    }
}

}  // namespace pt
