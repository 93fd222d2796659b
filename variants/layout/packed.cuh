// The layout packed: the path state in columns of 16 bytes, each a vector and a word, and one of 8 bytes. A lane moves
// a path in five accesses instead of eighteen. A ray is in the first two columns. Single precision only.
#pragma once

#include "variants/cuda/device/path_store.h"

namespace pt::layout::packed {

inline constexpr const char* name = "packed";

struct alignas(16) Column {
    float x, y, z;
    std::uint32_t w;
};
struct alignas(8) Key {
    std::uint32_t pixel, sample;
};

// The column in which a field of a path lies: the time beside the origin, the surface beside the direction, the segment
// beside the throughput, then the pixel and the sample, then the medium beside the radiance. Each further field has a
// column of its own.
enum class Place { base, optional, own };
constexpr Place place_of(PathField field) {
    switch (field) {
        case PathField::radiance:
        case PathField::medium:
            return Place::optional;
        case PathField::origin:
        case PathField::time:
        case PathField::direction:
        case PathField::origin_surface:
        case PathField::throughput:
        case PathField::segment:
        case PathField::pixel:
        case PathField::sample:
            return Place::base;
        default:
            return Place::own;
    }
}

// Bytes per path of those fields that come before a given field in the list and have columns of their own.
constexpr std::size_t own_bytes_before(std::size_t field) {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < field; ++i) {
        bytes += place_of(PathField{i}) == Place::own ? info(PathField{i}).bytes(sizeof(float)) : 0;
    }
    return bytes;
}

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Path<Real> load(std::uint32_t slot) const {
        const Column a = column(0)[slot], b = column(1)[slot], c = column(2)[slot], d = optional()[slot];
        const Key key = keys()[slot];
        Path<Real> path;
        path.origin = {a.x, a.y, a.z};
        path.time = bits_to_float(a.w);
        path.direction = {b.x, b.y, b.z};
        path.origin_surface = SurfaceId{b.w};
        path.throughput = {c.x, c.y, c.z};
        path.segment = c.w;
        path.pixel = key.pixel;
        path.sample = key.sample;
        path.radiance = {d.x, d.y, d.z};
        path.medium = d.w;
#define PT_LOAD(name, ...)                                         \
    if constexpr (place_of(PathField::name) == Place::own) {       \
        path.name = own<PathField::name>(&Path<Real>::name)[slot]; \
    }
        PT_PATH_FIELDS(PT_LOAD, PT_LOAD)
#undef PT_LOAD
        return path;
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { put<every_path_field>(slot, path); }
    // Writes all fields of a path that is new in its slot. The path's time is written together with its origin.
    template <PathFields carried>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        update<carried>(slot, path);
        keys()[slot] = {path.pixel, path.sample};
        store_own<FieldChange::never, carried>(slot, path);
    }
    // Writes the fields of a path that a bounce changes.
    template <PathFields carried>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        column(0)[slot] = {path.origin.x, path.origin.y, path.origin.z, word_of(path.time)};
        column(1)[slot] = {path.direction.x, path.direction.y, path.direction.z, path.origin_surface.code};
        column(2)[slot] = {path.throughput.x, path.throughput.y, path.throughput.z, path.segment};
        if constexpr (carried.radiance || carried.medium) {
            optional()[slot] = {path.radiance.x, path.radiance.y, path.radiance.z, path.medium};
        }
        store_own<FieldChange::by_bounce, carried>(slot, path);
    }
    PT_HD void end(std::uint32_t slot) const { column(2)[slot].w = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return column(2)[slot].w != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return keys()[slot].pixel; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return keys()[slot].sample; }
    PT_HD std::uint32_t& primitive(std::uint32_t slot) const {
        return own<PathField::primitive>(&Path<Real>::primitive)[slot];
    }
    PT_HD Ray<Real> ray(std::uint32_t slot) const {
        const Column a = column(0)[slot], b = column(1)[slot];
        return {{a.x, a.y, a.z}, {b.x, b.y, b.z}, bits_to_float(a.w), SurfaceId{b.w}};
    }

    // Bytes of a path store. The column of radiance and medium, and then those of single fields, come last, so what
    // lies behind the last column that paths carry is left out.
    static constexpr std::size_t bytes(std::uint32_t capacity, const PathFields& fields) {
        std::size_t bytes_per_slot = 3 * sizeof(Column) + sizeof(Key);
        const std::size_t begin_of_own = bytes_per_slot + sizeof(Column);
        for (std::size_t i = 0; i < path_field_count; ++i) {
            if (place_of(PathField{i}) == Place::base || !fields.carries(PathField{i})) {
                continue;
            }
            const std::size_t end =
                place_of(PathField{i}) == Place::own ? begin_of_own + own_bytes_before(i + 1) : begin_of_own;
            bytes_per_slot = end > bytes_per_slot ? end : bytes_per_slot;
        }
        // The column of radiance and medium starts at a multiple of 16 bytes.
        return bytes_per_slot * std::size_t{capacity} + sizeof(Key);
    }
    cuda::FieldView segment() const { return field(2); }
    cuda::FieldView origin_surface() const { return field(1); }

private:
    PT_HD Column* column(std::uint32_t i) const {
        return reinterpret_cast<Column*>(store_.base) + std::size_t{i} * store_.capacity;
    }
    PT_HD Key* keys() const { return reinterpret_cast<Key*>(column(3)); }
    PT_HD Column* optional() const {
        const std::size_t even = (std::size_t{store_.capacity} + 1) / 2 * 2;
        return reinterpret_cast<Column*>(keys() + even);
    }
    template <PathField field, class Value>
    PT_HD Value* own(Value Path<Real>::*) const {
        constexpr std::size_t before = own_bytes_before(static_cast<std::size_t>(field));
        auto* const begin = reinterpret_cast<unsigned char*>(optional() + store_.capacity);
        return reinterpret_cast<Value*>(begin + before * store_.capacity);
    }
    template <FieldChange change, PathFields carried>
    PT_HD void store_own(std::uint32_t slot, const Path<Real>& path) const {
#define PT_STORE(name, ...)                                                                                  \
    if constexpr (place_of(PathField::name) == Place::own && is_written(PathField::name, change, carried)) { \
        own<PathField::name>(&Path<Real>::name)[slot] = path.name;                                           \
    }
        PT_PATH_FIELDS(PT_STORE, PT_STORE)
#undef PT_STORE
    }
    cuda::FieldView field(std::uint32_t i) const {
        return {reinterpret_cast<const unsigned char*>(column(i)) + offsetof(Column, w), sizeof(Column)};
    }
    PT_HD static float bits_to_float(std::uint32_t bits) { return __builtin_bit_cast(float, bits); }
};

}  // namespace pt::layout::packed

#if defined(PT_HOST)  // host part of this file: the layout's descriptor

#include "variants/registry.h"

namespace pt::layout::packed {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary =
            "columns of 16 bytes: origin and time, direction and surface, throughput and segment, radiance and medium",
        .origin = "Laine, Karras and Aila 2013 (16-byte accesses)",
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
            if (variant.precision.is_single()) {
                return {};
            }
            return {"needs_single_precision", "packs single-precision fields: needs precision=float"};
        },
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::packed

#endif
