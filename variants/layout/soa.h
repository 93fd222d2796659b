// The layout soa on the CPU, a structure of arrays: every scalar of a path in an array of its own, so a stage reads
// only the fields that it needs.
#pragma once

#include <array>
#include <bit>
#include <vector>

#include <thrust/detail/type_traits.h>
#include <thrust/iterator/iterator_facade.h>

#include "kernels/intersect.h"
#include "kernels/path_fields.h"
#include "variants/descriptor.h"

namespace pt::layout::soa {

inline constexpr Descriptor descriptor{
    .axis = "layout",
    .name = "soa",
    .summary = "structure of arrays: one array a scalar of the path state",
    .origin = "pbrt-v4's soac; Laine, Karras and Aila 2013",
};

// Number of columns of one kind (of Real, or of 32 bits) that lie before those of a path's field: columns of fields
// that precede this field in the list.
constexpr std::size_t columns_before(std::size_t field, bool of_words) {
    std::size_t columns = 0;
    for (std::size_t i = 0; i < field; ++i) {
        const FieldType type = info(PathField{i}).type;
        columns += (type == FieldType::word) != of_words ? 0 : type == FieldType::vector ? 3 : 1;
    }
    return columns;
}
constexpr std::size_t column_of(PathField field) {
    return columns_before(static_cast<std::size_t>(field), info(field).type == FieldType::word);
}

// The columns of a path store. Real and 32-bit columns have separate storage.
template <class Real>
struct Columns {
    static constexpr std::size_t real_count = columns_before(path_field_count, false);
    static constexpr std::size_t word_count = columns_before(path_field_count, true);
    std::array<Real*, real_count> real{};
    std::array<std::uint32_t*, word_count> word{};

    template <PathField field>
    void load_vector(std::size_t slot, Vec3<Real>& value) const {
        constexpr std::size_t column = column_of(field);
        value = {real[column][slot], real[column + 1][slot], real[column + 2][slot]};
    }
    template <PathField field>
    void load_real(std::size_t slot, Real& value) const {
        value = real[column_of(field)][slot];
    }
    template <PathField field, class Word>
    void load_word(std::size_t slot, Word& value) const {
        value = Word{word[column_of(field)][slot]};
    }
    template <PathField field>
    void store_vector(std::size_t slot, const Vec3<Real>& value) const {
        constexpr std::size_t column = column_of(field);
        real[column][slot] = value.x;
        real[column + 1][slot] = value.y;
        real[column + 2][slot] = value.z;
    }
    template <PathField field>
    void store_real(std::size_t slot, Real value) const {
        real[column_of(field)][slot] = value;
    }
    template <PathField field, class Word>
    void store_word(std::size_t slot, const Word& value) const {
        word[column_of(field)][slot] = word_of(value);
    }
    Path<Real> load(std::size_t slot) const {
        Path<Real> path;
#define PT_LOAD(name, type, ...) load_##type<PathField::name>(slot, path.name);
        PT_PATH_FIELDS(PT_LOAD, PT_LOAD)
#undef PT_LOAD
        return path;
    }
    void store(std::size_t slot, const Path<Real>& path) const {
#define PT_STORE(name, type, ...) store_##type<PathField::name>(slot, path.name);
        PT_PATH_FIELDS(PT_STORE, PT_STORE)
#undef PT_STORE
    }
};

// A proxy for the path in a slot, where Thrust expects a reference to a path.
template <class Real>
class Reference {
public:
    Reference(const Columns<Real>* columns, std::size_t slot) : columns_(columns), slot_(slot) {}
    Reference(const Reference&) = default;
    operator Path<Real>() const { return columns_->load(slot_); }  // NOLINT: a reference converts
    const Reference& operator=(const Path<Real>& path) const {
        columns_->store(slot_, path);
        return *this;
    }
    const Reference& operator=(const Reference& other) const { return *this = static_cast<Path<Real>>(other); }
    friend void swap(Reference a, Reference b) {
        const Path<Real> kept = a;
        a = static_cast<Path<Real>>(b);
        b = kept;
    }

private:
    const Columns<Real>* columns_;
    std::size_t slot_;
};

template <class Real>
class Iterator : public thrust::iterator_facade<Iterator<Real>, Path<Real>, thrust::any_system_tag,
                                                thrust::random_access_traversal_tag, Reference<Real>, std::ptrdiff_t> {
public:
    Iterator() = default;
    Iterator(const Columns<Real>* columns, std::ptrdiff_t slot) : columns_(columns), slot_(slot) {}

private:
    friend class thrust::iterator_core_access;
    Reference<Real> dereference() const { return {columns_, static_cast<std::size_t>(slot_)}; }
    bool equal(const Iterator& other) const { return slot_ == other.slot_; }
    void increment() { ++slot_; }
    void decrement() { --slot_; }
    void advance(std::ptrdiff_t n) { slot_ += n; }
    std::ptrdiff_t distance_to(const Iterator& other) const { return other.slot_ - slot_; }

    const Columns<Real>* columns_ = nullptr;
    std::ptrdiff_t slot_ = 0;
};

}  // namespace pt::layout::soa

// Thrust assigns through a proxy reference only if this trait is true of it; Thrust's own iterators do so, too.
namespace thrust::detail {
template <class Real>
struct is_proxy_reference<pt::layout::soa::Reference<Real>> : true_type {};
}  // namespace thrust::detail

namespace pt::layout::soa {

template <class Real>
class Paths {
public:
    void reserve(std::size_t capacity) {
        if (capacity_ >= capacity) {
            return;
        }
        capacity_ = capacity;
        const std::size_t real_stride = stride(capacity, sizeof(Real));
        const std::size_t word_stride = stride(capacity, sizeof(std::uint32_t));
        reals_.assign(real_stride * Columns<Real>::real_count, Real(0));
        words_.assign(word_stride * Columns<Real>::word_count, 0u);
        for (std::size_t i = 0; i < columns_.real.size(); ++i) {
            columns_.real[i] = reals_.data() + i * real_stride;
        }
        for (std::size_t i = 0; i < columns_.word.size(); ++i) {
            columns_.word[i] = words_.data() + i * word_stride;
        }
    }
    Path<Real> load(std::size_t slot) const { return columns_.load(slot); }
    void store(std::size_t slot, const Path<Real>& path) { columns_.store(slot, path); }
    bool alive(std::size_t slot) const { return word<PathField::segment>(slot) != Path<Real>::ended; }
    std::uint32_t pixel(std::size_t slot) const { return word<PathField::pixel>(slot); }
    std::uint32_t primitive(std::size_t slot) const { return word<PathField::primitive>(slot); }
    Ray<Real> ray(std::size_t slot) const {
        Ray<Real> ray;
        columns_.template load_vector<PathField::origin>(slot, ray.origin);
        columns_.template load_vector<PathField::direction>(slot, ray.direction);
        columns_.template load_real<PathField::time>(slot, ray.time);
        columns_.template load_word<PathField::origin_surface>(slot, ray.origin_surface);
        return ray;
    }
    Iterator<Real> begin() { return {&columns_, 0}; }

private:
    template <PathField field>
    std::uint32_t word(std::size_t slot) const {
        return columns_.word[column_of(field)][slot];
    }
    // Elements from one column of a path store to the next: whole pages and three cache lines. Whole pages alone (an
    // 800x800 column is 625 of them) would put all columns of a slot into one set of a first-level cache, and measure
    // that instead of the layout.
    static std::size_t stride(std::size_t capacity, std::size_t element) {
        constexpr std::size_t page = 4096;
        constexpr std::size_t line = 64;
        return ((capacity * element + page - 1) / page * page + 3 * line) / element;
    }

    std::size_t capacity_ = 0;
    std::vector<Real> reals_;
    std::vector<std::uint32_t> words_;
    Columns<Real> columns_;
};

}  // namespace pt::layout::soa
