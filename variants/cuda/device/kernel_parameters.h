// A kernel's parameters are a struct for host and device, whose member `kernel` names the kernel: the host launches by
// the type of the struct, with its members as the kernel's parameters, and a kernel compiles only if its parameters are
// those members (PT_KERNEL in device.cuh). Shared by host and NVRTC.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

namespace pt::cuda {

namespace members {

// A value of any type, to count the members of a struct by how many values initialise it.
struct Any {
    template <class T>
    operator T() const;  // NOLINT: converts; only in expressions that are not evaluated
};

template <class Struct, class... Values>
constexpr std::size_t count() {
    if constexpr (requires { Struct{Values{}..., Any{}}; }) {
        return count<Struct, Values..., Any>();
    } else {
        return sizeof...(Values);
    }
}

template <class... Types>
struct List {};

template <class... Types>
List<std::remove_const_t<Types>...> list_of(Types&...);

}  // namespace members

// Calls visit(member, ...) with all members of a struct that has no more than 16.
template <class Struct, class Visit>
constexpr decltype(auto) visit_members(const Struct& s, Visit&& visit) {
    constexpr std::size_t count = members::count<Struct>();
    static_assert(count > 0 && count <= 16);
    if constexpr (count == 1) {
        const auto& [a] = s;
        return visit(a);
    } else if constexpr (count == 2) {
        const auto& [a, b] = s;
        return visit(a, b);
    } else if constexpr (count == 3) {
        const auto& [a, b, c] = s;
        return visit(a, b, c);
    } else if constexpr (count == 4) {
        const auto& [a, b, c, d] = s;
        return visit(a, b, c, d);
    } else if constexpr (count == 5) {
        const auto& [a, b, c, d, e] = s;
        return visit(a, b, c, d, e);
    } else if constexpr (count == 6) {
        const auto& [a, b, c, d, e, f] = s;
        return visit(a, b, c, d, e, f);
    } else if constexpr (count == 7) {
        const auto& [a, b, c, d, e, f, g] = s;
        return visit(a, b, c, d, e, f, g);
    } else if constexpr (count == 8) {
        const auto& [a, b, c, d, e, f, g, h] = s;
        return visit(a, b, c, d, e, f, g, h);
    } else if constexpr (count == 9) {
        const auto& [a, b, c, d, e, f, g, h, i] = s;
        return visit(a, b, c, d, e, f, g, h, i);
    } else if constexpr (count == 10) {
        const auto& [a, b, c, d, e, f, g, h, i, j] = s;
        return visit(a, b, c, d, e, f, g, h, i, j);
    } else if constexpr (count == 11) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k);
    } else if constexpr (count == 12) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k, l);
    } else if constexpr (count == 13) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k, l, m);
    } else if constexpr (count == 14) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
    } else if constexpr (count == 15) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
    } else if constexpr (count == 16) {
        const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = s;
        return visit(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
    }
}

template <class Struct>
using MemberList = decltype(visit_members(
    std::declval<const Struct&>(), [](const auto&... member) { return decltype(members::list_of(member...))(); }));

template <class Kernel>
struct ParameterList;
template <class... Types>
struct ParameterList<void(Types...)> {
    using type = members::List<std::remove_const_t<Types>...>;
};

// Whether a kernel of this name and type is the one whose parameters are the struct Parameters.
template <class Parameters, class Kernel>
constexpr bool is_kernel_of(const char* name) {
    const char* expected = Parameters::kernel;
    while (*name != '\0' && *name == *expected) {
        ++name;
        ++expected;
    }
    return *name == *expected && std::is_same_v<MemberList<Parameters>, typename ParameterList<Kernel>::type>;
}

// A kernel that the host launches: its name, the size of its parameters, and whether results report its registers.
struct KernelSignature {
    const char* name = nullptr;
    std::size_t parameter_bytes = 0;
    bool is_reported = true;           // whether results report the kernel's register count
    std::uint32_t most_threads = ~0u;  // most threads of the kernel's block, if fewer than the program's
};

template <class Parameters>
constexpr KernelSignature kernel_of(bool is_reported = true) {
    static_assert(std::is_trivially_copyable_v<Parameters>);
    if constexpr (requires { Parameters::most_threads; }) {
        return {Parameters::kernel, sizeof(Parameters), is_reported, Parameters::most_threads};
    } else {
        return {Parameters::kernel, sizeof(Parameters), is_reported};
    }
}

}  // namespace pt::cuda
