// Array of structures on the device: a path's fields lie together, as in both seeds.
#pragma once

#include "variants/cuda/path_store.h"

namespace pt::layout::aos {

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Path<Real>& at(std::uint32_t slot) const { return reinterpret_cast<Path<Real>*>(store_.base)[slot]; }
    PT_HD Path<Real> load(std::uint32_t slot) const { return at(slot); }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { at(slot) = path; }
    PT_HD bool alive(std::uint32_t slot) const { return at(slot).segment != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return at(slot).pixel; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return at(slot).sample; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const { return ray_of(at(slot)); }

    static std::size_t bytes(std::uint32_t capacity) { return sizeof(Path<Real>) * std::size_t{capacity}; }
    cuda::FieldView segment() const { return field(offsetof(Path<Real>, segment)); }
    cuda::FieldView departed() const { return field(offsetof(Path<Real>, departed)); }

private:
    cuda::FieldView field(std::size_t offset) const {
        return {store_.base + offset, static_cast<std::uint32_t>(sizeof(Path<Real>))};
    }
};

#if !defined(__CUDACC_RTC__)
inline constexpr Descriptor cuda_descriptor{
    .axis = "layout",
    .name = "aos",
    .summary = "array of structures: the fields of a path lie together",
    .origin = "both seeds (CIS 565 path tracers)",
    .baseline = on_cuda,
    .backends = on_cuda,
};
#endif

}  // namespace pt::layout::aos
