// Structure of arrays on the device: every scalar of a path in an array of its own, so that neighbouring lanes read
// neighbouring words and a stage reads only the fields that it needs.
#pragma once

#include "variants/cuda/path_store.h"

namespace pt::layout::soa {

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Path<Real> load(std::uint32_t slot) const {
        return {vector(0, slot), vector(3, slot), vector(6, slot), radiance(slot),           time()[slot],
                word(0)[slot],   word(1)[slot],   word(2)[slot],   SurfaceId{word(3)[slot]}, medium()[slot],
                density()[slot]};
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { put<true, true, true, true>(slot, path); }
    // A path that is new in its slot; of radiance, medium, time and density only what is asked for.
    template <bool has_radiance, bool has_medium, bool has_time, bool has_density>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        update<has_radiance, has_medium, has_density>(slot, path);
        if constexpr (has_time) {
            time()[slot] = path.time;
        }
        word(0)[slot] = path.pixel;
        word(1)[slot] = path.sample;
    }
    // What a bounce changes.
    template <bool has_radiance, bool has_medium, bool has_density>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        set_vector(0, slot, path.origin);
        set_vector(3, slot, path.direction);
        set_vector(6, slot, path.throughput);
        if constexpr (has_radiance) {
            Real* const column = optional();
            column[slot] = path.radiance.x;
            column[padded(store_.capacity) + slot] = path.radiance.y;
            column[2 * std::size_t{padded(store_.capacity)} + slot] = path.radiance.z;
        }
        word(2)[slot] = path.segment;
        word(3)[slot] = path.origin_surface.code;
        if constexpr (has_medium) {
            medium()[slot] = path.medium;
        }
        if constexpr (has_density) {
            density()[slot] = path.bsdf_pdf;
        }
    }
    PT_HD void end(std::uint32_t slot) const { word(2)[slot] = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return word(2)[slot] != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return word(0)[slot]; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return word(1)[slot]; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const {
        return {vector(0, slot), vector(3, slot), time()[slot], SurfaceId{word(3)[slot]}};
    }

#if !defined(__CUDACC_RTC__)
    // Columns that not every path carries come last, and those beyond the last one carried are not there.
    static std::size_t bytes(std::uint32_t capacity, const cuda::PathFields& fields) {
        const std::size_t always = 9 * sizeof(Real) + 4 * sizeof(std::uint32_t);
        const std::size_t optional = fields.density    ? 5 * sizeof(Real) + sizeof(std::uint32_t)
                                     : fields.medium   ? 4 * sizeof(Real) + sizeof(std::uint32_t)
                                     : fields.time     ? 4 * sizeof(Real)
                                     : fields.radiance ? 3 * sizeof(Real)
                                                       : 0;
        return (always + optional) * std::size_t{padded(capacity)};
    }
#endif
    cuda::FieldView segment() const { return {reinterpret_cast<const unsigned char*>(word(2)), 4}; }
    cuda::FieldView origin_surface() const { return {reinterpret_cast<const unsigned char*>(word(3)), 4}; }

private:
    // Columns start on 256-byte borders.
    PT_HD static std::uint32_t padded(std::uint32_t capacity) { return (capacity + 63u) / 64u * 64u; }
    PT_HD Real* real(std::uint32_t column) const {
        return reinterpret_cast<Real*>(store_.base) + std::size_t{column} * padded(store_.capacity);
    }
    PT_HD std::uint32_t* word(std::uint32_t column) const {
        return reinterpret_cast<std::uint32_t*>(real(9)) + std::size_t{column} * padded(store_.capacity);
    }
    // Radiance, time, medium and density.
    PT_HD Real* optional() const { return reinterpret_cast<Real*>(word(4)); }
    PT_HD Real* time() const { return optional() + 3 * std::size_t{padded(store_.capacity)}; }
    PT_HD Real* density() const { return reinterpret_cast<Real*>(medium() + padded(store_.capacity)); }
    PT_HD std::uint32_t* medium() const {
        return reinterpret_cast<std::uint32_t*>(optional() + 4 * std::size_t{padded(store_.capacity)});
    }
    PT_HD Vec3<Real> radiance(std::uint32_t slot) const {
        const std::size_t step = padded(store_.capacity);
        return {optional()[slot], optional()[step + slot], optional()[2 * step + slot]};
    }
    PT_HD Vec3<Real> vector(std::uint32_t column, std::uint32_t slot) const {
        return {real(column)[slot], real(column + 1)[slot], real(column + 2)[slot]};
    }
    PT_HD void set_vector(std::uint32_t column, std::uint32_t slot, const Vec3<Real>& v) const {
        real(column)[slot] = v.x;
        real(column + 1)[slot] = v.y;
        real(column + 2)[slot] = v.z;
    }
};

#if !defined(__CUDACC_RTC__)
inline constexpr Descriptor cuda_descriptor{
    .axis = "layout",
    .name = "soa",
    .summary = "structure of arrays: one array a scalar of the path state",
    .origin = "pbrt-v4's soac; Laine, Karras and Aila 2013",
    .backends = on_cuda,
};
#endif

}  // namespace pt::layout::soa
