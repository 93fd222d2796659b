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
        return {vector(0, slot), vector(3, slot), vector(6, slot), vector(9, slot),           real(12)[slot],
                word(0)[slot],   word(1)[slot],   word(2)[slot],   ObjectSide{word(3)[slot]}, word(4)[slot]};
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { put<true, true, true>(slot, path); }
    // A path that is new in its slot; of radiance, medium and time only what is asked for.
    template <bool radiance, bool medium, bool time>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        update<radiance, medium>(slot, path);
        if constexpr (time) {
            real(12)[slot] = path.time;
        }
        word(0)[slot] = path.pixel;
        word(1)[slot] = path.sample;
    }
    // What a bounce changes.
    template <bool radiance, bool medium>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        set_vector(0, slot, path.origin);
        set_vector(3, slot, path.direction);
        set_vector(6, slot, path.throughput);
        if constexpr (radiance) {
            set_vector(9, slot, path.radiance);
        }
        word(2)[slot] = path.segment;
        word(3)[slot] = path.departed.code;
        if constexpr (medium) {
            word(4)[slot] = path.medium;
        }
    }
    PT_HD void end(std::uint32_t slot) const { word(2)[slot] = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return word(2)[slot] != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return word(0)[slot]; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return word(1)[slot]; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const {
        return {vector(0, slot), vector(3, slot), real(12)[slot], ObjectSide{word(3)[slot]}};
    }

    static std::size_t bytes(std::uint32_t capacity) {
        return (13 * sizeof(Real) + 5 * sizeof(std::uint32_t)) * std::size_t{padded(capacity)};
    }
    cuda::FieldView segment() const { return {reinterpret_cast<const unsigned char*>(word(2)), 4}; }
    cuda::FieldView departed() const { return {reinterpret_cast<const unsigned char*>(word(3)), 4}; }

private:
    // Columns start on 256-byte borders.
    PT_HD static std::uint32_t padded(std::uint32_t capacity) { return (capacity + 63u) / 64u * 64u; }
    PT_HD Real* real(std::uint32_t column) const {
        return reinterpret_cast<Real*>(store_.base) + std::size_t{column} * padded(store_.capacity);
    }
    PT_HD std::uint32_t* word(std::uint32_t column) const {
        return reinterpret_cast<std::uint32_t*>(real(13)) + std::size_t{column} * padded(store_.capacity);
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
