// The axes, and what a variant's choices tell each other. A choice that depends on another one asks for a trait, never
// for a name, so a new choice works with all others by its traits alone. An axis is a folder with an axis.h: its facts
// and its traits, whose defaults are those of its usual choice.
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

// The keys of the axes, for code that means a certain one: a misspelt key is an error of the compiler.
namespace axes {
#define PT_KEY(name) inline constexpr char name[] = #name;
PT_AXES(PT_KEY)
#undef PT_KEY
}  // namespace axes

constexpr Axis keyed(std::string_view key, Axis facts) {
    facts.key = key;
    return facts;
}

// In the order in which a variant's name spells them.
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

// What a descriptor holds: nothing (the defaults of its axis), or the traits of its axis; in the order of axis_table.
#define PT_TRAITS(name) , name::Traits
using Traits = std::variant<std::monostate PT_AXES(PT_TRAITS)>;
#undef PT_TRAITS
static_assert(std::variant_size_v<Traits> == axis_count + 1);

// The name of the choice that a variant has, for messages alone, and its traits.
template <class AxisTraits>
struct Chosen : AxisTraits {
    std::string_view name;
};

// A variant as its choices see it: the traits of each axis's choice, by the name of the axis.
struct VariantTraits {
#define PT_CHOSEN(name) Chosen<name::Traits> name;
    PT_AXES(PT_CHOSEN)
#undef PT_CHOSEN
    std::map<std::string, std::uint32_t, std::less<>> tuning;  // Variant::tuning
};

// Why something does not apply: a key for programs and a text for people; empty: it applies.
struct Reason {
    std::string_view code = {};  // a short word that stays, for programs: "needs_queue"; empty: it applies
    std::string text = {};       // the sentence, for people
    std::string_view axis = {};  // of the choice that does not apply; empty: no choice's own (a tunable, a depth)

    bool empty() const { return code.empty(); }
};

}  // namespace pt
