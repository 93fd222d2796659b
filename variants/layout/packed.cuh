// The path state in four columns of 16 bytes and one of 8: a lane moves a path in five accesses instead of eighteen.
// Next-event estimation adds a column of 4 bytes.
// A ray is in the first two. Single precision only.
#pragma once

#include "variants/cuda/path_store.h"

namespace pt::layout::packed {

struct alignas(16) Column {
    float x, y, z;
    std::uint32_t w;
};
struct alignas(8) Key {
    std::uint32_t pixel, sample;
};

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Path<Real> load(std::uint32_t slot) const {
        const Column a = column(0)[slot], b = column(1)[slot], c = column(2)[slot], d = optional()[slot];
        const Key key = keys()[slot];
        return {{a.x, a.y, a.z},    {b.x, b.y, b.z},
                {c.x, c.y, c.z},    {d.x, d.y, d.z},
                bits_to_float(a.w), key.pixel,
                key.sample,         c.w,
                SurfaceId{b.w},     d.w,
                density()[slot]};
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { put<true, true, true, true>(slot, path); }
    // A path that is new in its slot; of radiance, medium and density only what is asked for (time comes with the
    // origin).
    template <bool radiance, bool medium, bool time, bool has_density>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        update<radiance, medium, has_density>(slot, path);
        keys()[slot] = {path.pixel, path.sample};
    }
    // What a bounce changes.
    template <bool radiance, bool medium, bool has_density>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        column(0)[slot] = {path.origin.x, path.origin.y, path.origin.z, float_to_bits(path.time)};
        column(1)[slot] = {path.direction.x, path.direction.y, path.direction.z, path.origin_surface.code};
        column(2)[slot] = {path.throughput.x, path.throughput.y, path.throughput.z, path.segment};
        if constexpr (radiance || medium) {
            optional()[slot] = {path.radiance.x, path.radiance.y, path.radiance.z, path.medium};
        }
        if constexpr (has_density) {
            density()[slot] = path.bsdf_pdf;
        }
    }
    PT_HD void end(std::uint32_t slot) const { column(2)[slot].w = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return column(2)[slot].w != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return keys()[slot].pixel; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return keys()[slot].sample; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const {
        const Column a = column(0)[slot], b = column(1)[slot];
        return {{a.x, a.y, a.z}, {b.x, b.y, b.z}, bits_to_float(a.w), SurfaceId{b.w}};
    }

#if !defined(__CUDACC_RTC__)
    // The time lies beside the origin; radiance and medium, and then the density, come last and may be left out.
    static std::size_t bytes(std::uint32_t capacity, const cuda::PathFields& fields) {
        const std::size_t always = 3 * sizeof(Column) + sizeof(Key);
        const std::size_t optional = fields.density                     ? sizeof(Column) + sizeof(float)
                                     : fields.radiance || fields.medium ? sizeof(Column)
                                                                        : 0;
        // The optional column starts on a border of 16 bytes.
        return (always + optional) * std::size_t{capacity} + sizeof(Key);
    }
#endif
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
    PT_HD float* density() const { return reinterpret_cast<float*>(optional() + store_.capacity); }
    cuda::FieldView field(std::uint32_t i) const {
        return {reinterpret_cast<const unsigned char*>(column(i)) + offsetof(Column, w), sizeof(Column)};
    }
    PT_HD static std::uint32_t float_to_bits(float value) { return __builtin_bit_cast(std::uint32_t, value); }
    PT_HD static float bits_to_float(std::uint32_t bits) { return __builtin_bit_cast(float, bits); }
};

#if !defined(__CUDACC_RTC__)
inline constexpr Descriptor cuda_descriptor{
    .axis = "layout",
    .name = "packed",
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
};
#endif

}  // namespace pt::layout::packed
