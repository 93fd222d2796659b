// A store in shared memory for paths of a warp that wait for a lane: one column for each word that this variant's paths
// carry.
#pragma once

#include "variants/cuda/device/device.cuh"

class WaitingPaths {
    template <class Value, bool is_carried>
    struct Column {
        Value values[warp_size];
        __device__ void put(std::uint32_t slot, Value value) { values[slot] = value; }
        __device__ Value get(std::uint32_t slot, Value) const { return values[slot]; }
    };
    template <class Value>
    struct Column<Value, false> {
        __device__ void put(std::uint32_t, Value) {}
        __device__ Value get(std::uint32_t, Value of_all_paths) const { return of_all_paths; }
    };
    template <bool is_carried>
    struct Vectors {
        Column<Real, is_carried> x, y, z;
        __device__ void put(std::uint32_t slot, const pt::Vec3<Real>& v) {
            x.put(slot, v.x);
            y.put(slot, v.y);
            z.put(slot, v.z);
        }
        __device__ pt::Vec3<Real> get(std::uint32_t slot, const pt::Vec3<Real>& of_all_paths) const {
            return {x.get(slot, of_all_paths.x), y.get(slot, of_all_paths.y), z.get(slot, of_all_paths.z)};
        }
    };

    using Walk = pt::WalkOf<Configuration>;
    static constexpr bool has_walks = pt::has<Configuration>(pt::Feature::subsurface);
    static constexpr bool guides_walks = pt::has<Configuration>(pt::Feature::guided_walk);

public:
    __device__ void put(std::uint32_t slot, const Path& path, const Walk& walk) {
#define PT_PUT_vector(name) name##_.put(slot, path.name);
#define PT_PUT_real(name) name##_.put(slot, path.name);
#define PT_PUT_word(name) name##_.put(slot, pt::word_of(path.name));
#define PT_PUT(name, type, ...) PT_PUT_##type(name)
        PT_PATH_FIELDS(PT_PUT, PT_PUT)
        walk_step_.put(slot, walk.step);
        walk_object_.put(slot, walk.object);
        walk_on_surface_.put(slot, walk.on_surface ? 1u : 0u);
        put_guide(slot, walk);
    }

    __device__ void get(std::uint32_t slot, const Scene& scene, Path& path, Walk& walk) const {
        using namespace pt;
#define PT_GET_vector(name, value) path.name = name##_.get(slot, value);
#define PT_GET_real(name, value) path.name = name##_.get(slot, value);
#define PT_GET_word(name, value) \
    path.name = __builtin_bit_cast(decltype(path.name), name##_.get(slot, pt::word_of(value)));
#define PT_GET_ALWAYS(name, type, ...) PT_GET_##type(name, path.name)
#define PT_GET_OPTIONAL(name, type, change, features, value) PT_GET_##type(name, value)
        PT_PATH_FIELDS(PT_GET_ALWAYS, PT_GET_OPTIONAL)
        walk.step = walk_step_.get(slot, walk.step);
        walk.object = walk_object_.get(slot, walk.object);
        walk.on_surface = walk_on_surface_.get(slot, walk.on_surface ? 1u : 0u) != 0;
        get_guide(slot, walk);
    }

private:
    // Stores the guide of a guided walk. A template, so that kernels without guided walks need not compile it.
    template <class WalkHere>
    __device__ void put_guide(std::uint32_t slot, const WalkHere& walk) {
        if constexpr (guides_walks) {
            walk_normal_.put(slot, walk.normal);
            walk_colour_.put(slot, walk.choice.colour);
            walk_choice_.put(slot, (walk.choice.is_guided ? 1u : 0u) + (walk.drew_direction ? 2u : 0u));
        }
    }
    template <class WalkHere>
    __device__ void get_guide(std::uint32_t slot, WalkHere& walk) const {
        if constexpr (guides_walks) {
            const std::uint32_t choice = walk_choice_.get(slot, 0u);
            walk.normal = walk_normal_.get(slot, walk.normal);
            walk.choice = {walk_colour_.get(slot, 0u), (choice & 1u) != 0};
            walk.drew_direction = (choice & 2u) != 0;
        }
    }

#define PT_COLUMN_vector(name, is_carried) Vectors<is_carried> name##_;
#define PT_COLUMN_real(name, is_carried) Column<Real, is_carried> name##_;
#define PT_COLUMN_word(name, is_carried) Column<std::uint32_t, is_carried> name##_;
#define PT_COLUMN_ALWAYS(name, type, ...) PT_COLUMN_##type(name, true)
#define PT_COLUMN_OPTIONAL(name, type, ...) PT_COLUMN_##type(name, carried_fields.name)
    PT_PATH_FIELDS(PT_COLUMN_ALWAYS, PT_COLUMN_OPTIONAL)
    Column<std::uint32_t, has_walks> walk_step_, walk_object_, walk_on_surface_;
    Vectors<guides_walks> walk_normal_;
    Column<std::uint32_t, guides_walks> walk_colour_, walk_choice_;
};
