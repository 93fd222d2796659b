// The list of all axes, and what a variant's choices may ask of each other. A choice that depends on another one asks
// for a trait, never for a name, so a new choice works with all others by its traits alone. An axis is a folder
// variants/AXIS whose axis.h declares the axis's facts and its traits; the traits default to those of the usual choice.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <variant>

#include "axis_list.h"  // generated: every variants/AXIS/axis.h, and PT_AXES with their names in their order

namespace pt {

// String constants with the names of the axes, for code that means a certain axis: a misspelt name does not compile.
namespace axes {
#define PT_KEY(name) inline constexpr char name[] = #name;
PT_AXES(PT_KEY)
#undef PT_KEY
}  // namespace axes

constexpr Axis keyed(std::string_view key, Axis facts) {
    facts.key = key;
    return facts;
}

// All axes, in the order in which a variant's name spells them.
#define PT_AXIS(name) keyed(#name, name::axis_facts),
inline constexpr Axis axis_table[] = {PT_AXES(PT_AXIS)};
#undef PT_AXIS
inline constexpr std::size_t axis_count = std::size(axis_table);
static_assert(std::ranges::is_sorted(axis_table, std::ranges::less_equal{}, &Axis::order));

inline constexpr std::array<std::string_view, axis_count> axis_names = [] {
    std::array<std::string_view, axis_count> names;
    for (std::size_t i = 0; i < axis_count; ++i) {
        names[i] = axis_table[i].key;
    }
    return names;
}();

// The traits in a choice's descriptor: std::monostate (the defaults of its axis), or the traits of its axis.
#define PT_TRAITS(name) , name::Traits
using Traits = std::variant<std::monostate PT_AXES(PT_TRAITS)>;
#undef PT_TRAITS
static_assert(std::variant_size_v<Traits> == axis_count + 1);

// The traits of the choice that a variant has on an axis, and the choice's name, which is for messages alone.
template <class AxisTraits>
struct Chosen : AxisTraits {
    std::string_view name;
};

// A variant as its choices see it: the traits of its choice on each axis, in a member named after the axis.
struct VariantTraits {
#define PT_CHOSEN(name) Chosen<name::Traits> name;
    PT_AXES(PT_CHOSEN)
#undef PT_CHOSEN
    std::map<std::string, std::uint32_t, std::less<>> tuning;  // values of the variant's tunables (Variant::tuning)
};

// Why a variant or one of its choices cannot run: a short code for programs and a sentence for people.
struct Reason {
    std::string_view code = {};  // a short word that stays the same: "needs_queue"; empty: the variant can run
    std::string text = {};       // the reason why something cannot run, as a sentence for people
    std::string_view axis = {};  // axis on which the choice cannot run; empty if a tunable or the depth is the reason

    bool empty() const { return code.empty(); }
};

}  // namespace pt
