// The kind of a path's next stage as a number; and a path packed in words of 32 bits, four to a column, as paths lie in
// shared memory between two stages (path_pool.cuh).
#pragma once

#include "variants/cuda/device/device.cuh"
#include "variants/cuda/device/surface_kinds.h"

struct Kinds {
    static constexpr bool has_walks = pt::has<Configuration>(pt::Feature::subsurface);
    // kind of a path that shading ends, or of a slot without a path: a new path begins there
    static constexpr std::uint32_t over = 0;
    static constexpr auto surfaces =
        pt::cuda::SurfaceKinds::of(Configuration::features, tuned::by_material != 0, over + 1);
    static constexpr std::uint32_t walking = over + 1 + surfaces.count;       // kind of a path on a walk in a body
    static constexpr std::uint32_t starting = walking + (has_walks ? 1 : 0);  // kind of a path with a next ray to trace
    static constexpr std::uint32_t lists = starting + (has_walks ? 1 : 0);    // number of kinds with rings of paths
    static constexpr std::uint32_t retired = lists;                           // kind of a slot that gets no more paths
    static constexpr std::uint32_t nothing = lists + 1;                       // kind of a lane without a slot
    static_assert(nothing < 16);

    __device__ static std::uint32_t of(pt::MaterialType type) {
        return static_cast<std::uint32_t>(surfaces.table >> (4 * static_cast<std::uint32_t>(type))) & 15u;
    }
    // The kind of a path's next stage, once the path's segment was traced.
    __device__ static std::uint32_t of(const Scene& scene, const Path& path, const Hit& hit) {
        if (!hit.side.exists() || path.segment + 1 >= scene.longest_path()) {
            return over;
        }
        return of(scene.surfaces[hit.side.object()].type);
    }
    __device__ static bool is_traced(std::uint32_t kind) { return kind < walking; }
    // Whether paths of this kind take a walk's step: they are within a body, or enter one if the boundary lets them.
    __device__ static bool may_walk(std::uint32_t kind) {
        return has_walks && (kind == walking || (tuned::by_material != 0 && kind == of(pt::MaterialType::subsurface)));
    }
};

__device__ constexpr std::size_t bytes_carried() {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < pt::path_field_count; ++i) {
        const auto field = static_cast<pt::PathField>(i);
        bytes += carried_fields.carries(field) ? pt::info(field).bytes(sizeof(Real)) : 0;
    }
    return bytes;
}

// A path's carried fields (PT_PATH_FIELDS) and its hit or, on a walk, the walk's place, in columns of 16 bytes.
class PackedPath {
    static constexpr std::size_t words = bytes_carried() / 4 + sizeof(Real) / 4 + 1 + (Kinds::has_walks ? 1 : 0);

public:
    static constexpr std::uint32_t columns = (words + 3) / 4;
    uint4 column[columns];

    // Packs a path with its hit and its walk. The triangle of a mesh that the path has met goes into path.primitive.
    __device__ void pack(const Path& path, const Hit& hit, const pt::Walk& walk) {
        at_ = 0;
#define PT_PACK(name, type, change) put(path.name);
#define PT_PACK_CARRIED(name, type, change, features, value) \
    if constexpr (carried_fields.name) {                     \
        put(path.name);                                      \
    }
        PT_PATH_FIELDS(PT_PACK, PT_PACK_CARRIED)
#undef PT_PACK
#undef PT_PACK_CARRIED
        put(hit.t);
        if constexpr (Kinds::has_walks) {
            put(walk.step);
            put(walk.is_on() ? pt::SurfaceId::of(walk.object, walk.on_surface) : hit.side);
        } else {
            put(hit.side);
        }
    }
    __device__ void unpack(const Scene& scene, Path& path, Hit& hit, pt::Walk& walk) {
        using namespace pt;
        at_ = 0;
#define PT_UNPACK(name, type, change) get(path.name);
#define PT_UNPACK_CARRIED(name, type, change, features, value) \
    if constexpr (carried_fields.name) {                       \
        get(path.name);                                        \
    } else {                                                   \
        path.name = value;                                     \
    }
        PT_PATH_FIELDS(PT_UNPACK, PT_UNPACK_CARRIED)
#undef PT_UNPACK
#undef PT_UNPACK_CARRIED
        get(hit.t);
        if constexpr (Kinds::has_walks) {
            get(walk.step);
        }
        get(hit.side);
        walk.object = hit.side.object();
        walk.on_surface = hit.side.inside();
        hit.primitive = path.primitive;
    }

private:
    __device__ std::uint32_t& word() {
        const std::uint32_t i = at_++;
        uint4& four = column[i / 4];
        return i % 4 == 0 ? four.x : i % 4 == 1 ? four.y : i % 4 == 2 ? four.z : four.w;
    }
    __device__ void put(std::uint32_t value) { word() = value; }
    __device__ void put(const pt::SurfaceId& value) { word() = value.code; }
    __device__ void put(float value) { word() = __float_as_uint(value); }
    __device__ void put(double value) {
        word() = static_cast<std::uint32_t>(__double2loint(value));
        word() = static_cast<std::uint32_t>(__double2hiint(value));
    }
    __device__ void put(const pt::Vec3<Real>& value) {
        put(value.x);
        put(value.y);
        put(value.z);
    }
    __device__ void get(std::uint32_t& value) { value = word(); }
    __device__ void get(pt::SurfaceId& value) { value.code = word(); }
    __device__ void get(float& value) { value = __uint_as_float(word()); }
    __device__ void get(double& value) {
        const int low = static_cast<int>(word());
        value = __hiloint2double(static_cast<int>(word()), low);
    }
    __device__ void get(pt::Vec3<Real>& value) {
        get(value.x);
        get(value.y);
        get(value.z);
    }

    std::uint32_t at_ = 0;
};
