// The paths of a store as a random-access iterator over Path<float>, for Thrust and CUB on the device: a pointer where
// a path's fields lie together, else a proxy that gathers and scatters the fields.
#pragma once

#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include <thrust/detail/type_traits.h>
#include <thrust/iterator/iterator_facade.h>

#include "device_layouts.h"  // generated: every layout by the name of its file
#include "variants/descriptor.h"

namespace pt::cuda {

// A proxy for the value in a slot where an algorithm expects a reference. Slots has load(slot), store(slot, value).
template <class Slots>
class SlotReference {
public:
    using Value = decltype(std::declval<Slots>().load(0));

    PT_HD SlotReference(const Slots& slots, std::uint32_t slot) : slots_(slots), slot_(slot) {}
    SlotReference(const SlotReference&) = default;
    PT_HD operator Value() const { return slots_.load(slot_); }  // NOLINT: a reference converts
    PT_HD const SlotReference& operator=(const Value& value) const {
        slots_.store(slot_, value);
        return *this;
    }
    // Assigns the value in the other reference's slot; the reference itself stays with its slot.
    PT_HD const SlotReference& operator=(const SlotReference& other) const { return *this = static_cast<Value>(other); }

private:
    Slots slots_;
    std::uint32_t slot_;
};

template <class Slots>
class SlotIterator
    : public thrust::iterator_facade<SlotIterator<Slots>, typename SlotReference<Slots>::Value, thrust::any_system_tag,
                                     thrust::random_access_traversal_tag, SlotReference<Slots>, std::ptrdiff_t> {
public:
    PT_HD SlotIterator() : slots_(PathStore{}) {}
    PT_HD explicit SlotIterator(const Slots& slots) : slots_(slots) {}

private:
    friend class thrust::iterator_core_access;
    PT_HD SlotReference<Slots> dereference() const { return {slots_, static_cast<std::uint32_t>(slot_)}; }
    PT_HD bool equal(const SlotIterator& other) const { return slot_ == other.slot_; }
    PT_HD void increment() { ++slot_; }
    PT_HD void decrement() { --slot_; }
    PT_HD void advance(std::ptrdiff_t n) { slot_ += n; }
    PT_HD std::ptrdiff_t distance_to(const SlotIterator& other) const { return other.slot_ - slot_; }

    Slots slots_;
    std::ptrdiff_t slot_ = 0;
};

// An iterator over the paths of a store that begins at slot 0.
template <class Paths>
auto payload_begin(const PathStore& store) {
    if constexpr (requires(const Paths& paths) { paths.records(); }) {
        return Paths(store).records();
    } else {
        return SlotIterator<Paths>(Paths(store));
    }
}

// Calls visit(std::type_identity<DevicePaths<float>>()) with the DevicePaths of the layout of this name.
template <class Visit>
auto visit_layout(std::string_view name, Visit&& visit) {
#define PT_VISIT(file)                                                        \
    if (name == layout::file::name) {                                         \
        return visit(std::type_identity<layout::file::DevicePaths<float>>()); \
    }
    PT_DEVICE_LAYOUTS(PT_VISIT)
#undef PT_VISIT
    throw std::logic_error("no layout=" + std::string(name));
}

// Why a choice that moves whole paths cannot run: iterators over paths are for Path<float> alone. Empty: it can.
inline Reason needs_single_precision(FeatureSet, const VariantTraits& variant) {
    if (variant.precision.is_single()) {
        return {};
    }
    return {"needs_single_precision", "moves single-precision payloads: needs precision=float"};
}

struct PathIsAlive {
    PT_HD bool operator()(const Path<float>& path) const { return path.alive(); }
};
struct PathHasEnded {
    PT_HD bool operator()(const Path<float>& path) const { return !path.alive(); }
};

}  // namespace pt::cuda

// Thrust assigns through a proxy reference only if this trait is true of it; Thrust's own iterators do so, too.
THRUST_NAMESPACE_BEGIN
namespace detail {
template <class Slots>
struct is_proxy_reference<pt::cuda::SlotReference<Slots>> : true_type {};
}  // namespace detail
THRUST_NAMESPACE_END
