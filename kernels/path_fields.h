// The fields of a path, listed once. How a path lies in memory between two stages, whatever the layout, which fields a
// scene's kernels carry, and which of them a bounce changes all follow from this list.
#pragma once

#include "kernels/config.h"
#include "kernels/path.h"

namespace pt {

enum class FieldType {
    vector,  // vector of three numbers of type Real
    real,
    word  // 32 bits
};

enum class FieldChange { by_bounce, never };  // when a path's field is written: at bounces, or only as the path begins

// The fields of struct Path in their order. ALWAYS(name, type, change): every path carries the field.
// OPTIONAL(name, type, change, features, value): it is carried by kernels with one of these features; in others all
// paths have this value (`scene`: the scene that the path is in).
#define PT_PATH_FIELDS(ALWAYS, OPTIONAL)                                                                \
    ALWAYS(origin, vector, by_bounce)                                                                   \
    ALWAYS(direction, vector, by_bounce)                                                                \
    ALWAYS(throughput, vector, by_bounce)                                                               \
    OPTIONAL(radiance, vector, by_bounce, Feature::emission | Feature::next_event, Vec3<Real>(0, 0, 0)) \
    OPTIONAL(time, real, never, set_of(Feature::motion), scene.camera.shutter_open)                     \
    ALWAYS(pixel, word, never)                                                                          \
    ALWAYS(sample, word, never)                                                                         \
    ALWAYS(segment, word, by_bounce)                                                                    \
    ALWAYS(origin_surface, word, by_bounce)                                                             \
    OPTIONAL(medium, word, by_bounce, set_of(Feature::absorption), scene.camera.initial_medium)         \
    OPTIONAL(bsdf_pdf, real, by_bounce, set_of(Feature::next_event), Real(0))                           \
    OPTIONAL(primitive, word, by_bounce, set_of(Feature::mesh), 0u)

#define PT_NO_FIELD(...)

enum class PathField : std::size_t {
#define PT_NAME(name, ...) name,
    PT_PATH_FIELDS(PT_NAME, PT_NAME)
#undef PT_NAME
};

struct PathFieldInfo {
    const char* name;  // name of the member of struct Path
    FieldType type;
    FieldChange change;
    bool is_optional;
    FeatureSet features;  // features of kernels that carry the field; for an optional field

    PT_HD constexpr std::size_t bytes(std::size_t real_bytes) const {
        return type == FieldType::vector ? 3 * real_bytes
               : type == FieldType::real ? real_bytes
                                         : sizeof(std::uint32_t);
    }
};

inline constexpr PathFieldInfo path_field_table[] = {
#define PT_ALWAYS(name, type, change) {#name, FieldType::type, FieldChange::change, false, all_features},
#define PT_OPTIONAL(name, type, change, features, value) {#name, FieldType::type, FieldChange::change, true, features},
    PT_PATH_FIELDS(PT_ALWAYS, PT_OPTIONAL)
#undef PT_ALWAYS
#undef PT_OPTIONAL
};
inline constexpr std::size_t path_field_count = sizeof path_field_table / sizeof path_field_table[0];

PT_HD constexpr PathFieldInfo info(PathField field) { return path_field_table[static_cast<std::size_t>(field)]; }

// A path field that is in struct Path but not in the list of fields would be lost between two stages.
static_assert([] {
    std::size_t bytes = 0;
    for (const PathFieldInfo& field : path_field_table) {
        bytes += field.bytes(sizeof(float));
    }
    return bytes == sizeof(Path<float>);
}());

// The optional fields that the paths of a queue carry.
struct PathFields {
#define PT_MEMBER(name, ...) bool name = true;
    PT_PATH_FIELDS(PT_NO_FIELD, PT_MEMBER)
#undef PT_MEMBER

    PT_HD static constexpr PathFields of(FeatureSet kernel) {
        PathFields fields;
#define PT_CARRY(name, type, change, features, value) fields.name = (kernel & (features)) != 0;
        PT_PATH_FIELDS(PT_NO_FIELD, PT_CARRY)
#undef PT_CARRY
        return fields;
    }
    PT_HD constexpr bool carries(PathField field) const {
        bool carried = true;
#define PT_CARRIED(name, ...) carried = field == PathField::name ? name : carried;
        PT_PATH_FIELDS(PT_NO_FIELD, PT_CARRIED)
#undef PT_CARRIED
        return carried;
    }
};
inline constexpr PathFields every_path_field{};

// Whether stages whose changes are of the kind `change` write `field` to a queue whose paths carry `carried`.
PT_HD constexpr bool is_written(PathField field, FieldChange change, const PathFields& carried) {
    return info(field).change == change && carried.carries(field);
}

// The 32 bits of a field, as a column of a queue holds them.
template <class Field>
PT_HD inline std::uint32_t word_of(const Field& field) {
    return __builtin_bit_cast(std::uint32_t, field);
}

}  // namespace pt
