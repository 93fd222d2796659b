// The layout aos on the device, an array of structures: a path's fields lie together, as in cis565 (whose records have
// no padding).
#pragma once

#include "variants/cuda/device/path_store.h"

namespace pt::layout::aos {

inline constexpr const char* name = "aos";

struct alignas(16) Piece {
    std::uint32_t x, y, z, w;
};

// A path padded to whole 16-byte pieces: a lane reads it in five accesses, and Thrust moves it in five.
template <class Real>
struct alignas(16) Record {
    static_assert(sizeof(Path<Real>) % 16 == 0);
    Path<Real> path;

    Record() = default;
    PT_HD Record(const Path<Real>& p) : path(p) {}             // NOLINT: algorithms move either
    PT_HD operator const Path<Real>&() const { return path; }  // NOLINT
};

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Record<Real>* records() const { return reinterpret_cast<Record<Real>*>(store_.base); }
    PT_HD Path<Real> load(std::uint32_t slot) const {
        const Piece* const source = pieces(slot);
        Pieces copy;
        for (std::size_t i = 0; i < piece_count; ++i) {
            copy.piece[i] = source[i];
        }
        return __builtin_bit_cast(Record<Real>, copy).path;
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const {
        const Pieces copy = __builtin_bit_cast(Pieces, Record<Real>(path));
        for (std::size_t i = 0; i < piece_count; ++i) {
            pieces(slot)[i] = copy.piece[i];
        }
    }
    // A path's whole record is written, since its 16-byte pieces mix fields that a bounce changes with others.
    template <PathFields carried>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        store(slot, path);
    }
    template <PathFields carried>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        store(slot, path);
    }
    PT_HD void end(std::uint32_t slot) const { at(slot).segment = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return at(slot).segment != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return at(slot).pixel; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return at(slot).sample; }
    PT_HD std::uint32_t& primitive(std::uint32_t slot) const { return at(slot).primitive; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const { return ray_of(load(slot)); }

    // Bytes of a path store. A slot has the whole record of a path, whatever the scene's kernels carry, as in cis565.
    static constexpr std::size_t bytes(std::uint32_t capacity, const PathFields&) {
        return sizeof(Record<Real>) * std::size_t{capacity};
    }
    cuda::FieldView segment() const { return field(offsetof(Path<Real>, segment)); }
    cuda::FieldView origin_surface() const { return field(offsetof(Path<Real>, origin_surface)); }

private:
    static constexpr std::size_t piece_count = sizeof(Record<Real>) / sizeof(Piece);
    struct Pieces {
        Piece piece[piece_count];
    };
    PT_HD Piece* pieces(std::uint32_t slot) const { return reinterpret_cast<Piece*>(&records()[slot]); }
    PT_HD Path<Real>& at(std::uint32_t slot) const { return records()[slot].path; }
    cuda::FieldView field(std::size_t offset) const {
        return {store_.base + offset, static_cast<std::uint32_t>(sizeof(Record<Real>))};
    }
};

}  // namespace pt::layout::aos

#if defined(PT_HOST)  // host part of this file: the layout's descriptor

#include "variants/registry.h"

namespace pt::layout::aos {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary = "array of structures: the fields of a path lie together",
        .origin = "cis565 (two CIS 565 path tracers)",
        .baseline = on_cuda,
        .traits = LayoutTraits{.keeps_paths_whole = true},
        .backends = on_cuda,
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::aos

#endif
