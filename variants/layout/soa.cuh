// The layout soa on the device, a structure of arrays: every scalar of a path in an array of its own, so that
// neighbouring lanes read neighbouring words and a stage reads only the fields that it needs.
#pragma once

#include <type_traits>
#include "variants/cuda/device/path_store.h"

namespace pt::layout::soa {

inline constexpr const char* name = "soa";

// Columns of a path store, one a scalar, lie in the order of the list of fields, but those that every path carries come
// first, and among them those of Real. A column that the paths of a queue do not carry has its place all the same,
// unless no column that they do carry lies behind it.
constexpr bool lies_before(PathField field, PathField other) {
    const PathFieldInfo a = info(field), b = info(other);
    if (a.is_optional != b.is_optional) {
        return b.is_optional;
    }
    const bool a_is_word = a.type == FieldType::word, b_is_word = b.type == FieldType::word;
    return !a.is_optional && a_is_word != b_is_word ? b_is_word : field < other;
}

constexpr std::size_t columns_of(PathField field) { return info(field).type == FieldType::vector ? 3 : 1; }

// Number of the first column that holds a path's field.
constexpr std::size_t first_column(PathField field) {
    std::size_t columns = 0;
    for (std::size_t i = 0; i < path_field_count; ++i) {
        columns += lies_before(PathField{i}, field) ? columns_of(PathField{i}) : 0;
    }
    return columns;
}

constexpr bool is_word(std::size_t column) {
    for (std::size_t i = 0; i < path_field_count; ++i) {
        if (column - first_column(PathField{i}) < columns_of(PathField{i})) {
            return info(PathField{i}).type == FieldType::word;
        }
    }
    return false;
}

// The first in the run of columns of one type to which a column belongs.
constexpr std::size_t first_of_type(std::size_t column) {
    while (column > 0 && is_word(column - 1) == is_word(column)) {
        column -= 1;
    }
    return column;
}

template <class Real>
struct DevicePaths {
    cuda::PathStore store_;

    PT_HD explicit DevicePaths(const cuda::PathStore& store) : store_(store) {}
    PT_HD Path<Real> load(std::uint32_t slot) const {
        Path<Real> path;
#define PT_LOAD(name, type, ...) load_##type<PathField::name>(slot, path.name);
        PT_PATH_FIELDS(PT_LOAD, PT_LOAD)
#undef PT_LOAD
        return path;
    }
    PT_HD void store(std::uint32_t slot, const Path<Real>& path) const { put<every_path_field>(slot, path); }
    // Writes all fields of a path that is new in its slot.
    template <PathFields carried>
    PT_HD void put(std::uint32_t slot, const Path<Real>& path) const {
        store_fields<FieldChange::by_bounce, carried>(slot, path);
        store_fields<FieldChange::never, carried>(slot, path);
    }
    // Writes those fields of a path that a bounce changes.
    template <PathFields carried>
    PT_HD void update(std::uint32_t slot, const Path<Real>& path) const {
        store_fields<FieldChange::by_bounce, carried>(slot, path);
    }
    PT_HD void end(std::uint32_t slot) const { scalars<PathField::segment>()[slot] = Path<Real>::ended; }
    PT_HD bool alive(std::uint32_t slot) const { return scalars<PathField::segment>()[slot] != Path<Real>::ended; }
    PT_HD std::uint32_t pixel(std::uint32_t slot) const { return scalars<PathField::pixel>()[slot]; }
    PT_HD std::uint32_t sample(std::uint32_t slot) const { return scalars<PathField::sample>()[slot]; }
    PT_HD std::uint32_t& primitive(std::uint32_t slot) const { return scalars<PathField::primitive>()[slot]; }
    PT_HD Ray<Real> ray(std::uint32_t slot) const {
        Ray<Real> ray;
        load_vector<PathField::origin>(slot, ray.origin);
        load_vector<PathField::direction>(slot, ray.direction);
        load_real<PathField::time>(slot, ray.time);
        load_word<PathField::origin_surface>(slot, ray.origin_surface);
        return ray;
    }

    static constexpr std::size_t bytes(std::uint32_t capacity, const PathFields& fields) {
        std::size_t columns = 0;
        for (std::size_t i = 0; i < path_field_count; ++i) {
            const std::size_t end = first_column(PathField{i}) + columns_of(PathField{i});
            columns = fields.carries(PathField{i}) && end > columns ? end : columns;
        }
        std::size_t bytes_per_slot = 0;
        for (std::size_t column = 0; column < columns; ++column) {
            bytes_per_slot += is_word(column) ? sizeof(std::uint32_t) : sizeof(Real);
        }
        return bytes_per_slot * std::size_t{padded(capacity)};
    }
    cuda::FieldView segment() const { return view<PathField::segment>(); }
    cuda::FieldView origin_surface() const { return view<PathField::origin_surface>(); }

private:
    // Length of a column in elements: columns start at multiples of 256 bytes.
    PT_HD static constexpr std::uint32_t padded(std::uint32_t capacity) { return (capacity + 63u) / 64u * 64u; }
    template <std::size_t column>
    using Element = std::conditional_t<is_word(column), std::uint32_t, Real>;

    // The address of a column, reckoned in whole columns from the first column of its type: reckoned in bytes from the
    // begin of the store, addresses take more registers.
    template <std::size_t column>
    PT_HD Element<column>* at() const {
        constexpr std::size_t first = first_of_type(column);
        return begin<first>() + (column - first) * padded(store_.capacity);
    }
    template <std::size_t first>
    PT_HD Element<first>* begin() const {
        if constexpr (first == 0) {
            return reinterpret_cast<Element<first>*>(store_.base);
        } else {
            constexpr std::size_t before = first_of_type(first - 1);
            return reinterpret_cast<Element<first>*>(begin<before>() + (first - before) * padded(store_.capacity));
        }
    }
    template <PathField field>
    PT_HD auto* scalars() const {
        return at<first_column(field)>();
    }
    template <PathField field>
    cuda::FieldView view() const {
        return {reinterpret_cast<const unsigned char*>(scalars<field>()), sizeof(std::uint32_t)};
    }

    template <PathField field>
    PT_HD void load_vector(std::uint32_t slot, Vec3<Real>& value) const {
        constexpr std::size_t x = first_column(field);
        // Addresses of an optional vector start from the first of its three columns, and the second column has a 32-bit
        // index: other forms of these addresses change the registers of kernels that carry the vector.
        if constexpr (info(field).is_optional) {
            const std::size_t step = padded(store_.capacity);
            value = {at<x>()[slot], at<x>()[step + slot], at<x>()[2 * step + slot]};
        } else {
            value = {at<x>()[slot], at<x + 1>()[slot], at<x + 2>()[slot]};
        }
    }
    template <PathField field>
    PT_HD void load_real(std::uint32_t slot, Real& value) const {
        value = scalars<field>()[slot];
    }
    template <PathField field, class Word>
    PT_HD void load_word(std::uint32_t slot, Word& value) const {
        value = Word{scalars<field>()[slot]};
    }
    template <PathField field>
    PT_HD void store_vector(std::uint32_t slot, const Vec3<Real>& value) const {
        constexpr std::size_t x = first_column(field);
        if constexpr (info(field).is_optional) {
            const std::size_t step = padded(store_.capacity);
            at<x>()[slot] = value.x;
            at<x>()[padded(store_.capacity) + slot] = value.y;
            at<x>()[2 * step + slot] = value.z;
        } else {
            at<x>()[slot] = value.x;
            at<x + 1>()[slot] = value.y;
            at<x + 2>()[slot] = value.z;
        }
    }
    template <PathField field>
    PT_HD void store_real(std::uint32_t slot, Real value) const {
        scalars<field>()[slot] = value;
    }
    template <PathField field, class Word>
    PT_HD void store_word(std::uint32_t slot, const Word& value) const {
        scalars<field>()[slot] = word_of(value);
    }
    template <FieldChange change, PathFields carried>
    PT_HD void store_fields(std::uint32_t slot, const Path<Real>& path) const {
#define PT_STORE(name, type, ...)                                 \
    if constexpr (is_written(PathField::name, change, carried)) { \
        store_##type<PathField::name>(slot, path.name);           \
    }
        PT_PATH_FIELDS(PT_STORE, PT_STORE)
#undef PT_STORE
    }
};

}  // namespace pt::layout::soa

#if defined(PT_HOST)  // host part of this file: the layout's descriptor

#include "variants/registry.h"

namespace pt::layout::soa {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary = "structure of arrays: one array a scalar of the path state",
        .origin = "pbrt-v4's soac; Laine, Karras and Aila 2013",
        .backends = on_cuda,
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::soa

#endif
