// Converts structs to and from JSON objects by a list of their fields. A struct has a static function template
//     fields(self, visit)
// which calls visit(KEY, self.member) for every field, in the order in which the keys are written. A member that is a
// std::optional is a key that may be absent; visit.or_null(KEY, self.member) is a key that is always there and null
// where the optional is empty.
#pragma once

#include <concepts>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "harness/json_reader.h"

namespace pt {

// Thrown when a JSON value lacks the expected facts; the message says what was found: "pt_rays null", "no film_hash".
class WrongFact : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// What reading a struct from JSON does when a required key is missing.
enum class Missing { is_refused, is_left_out };

namespace fields_detail {

struct Ignore {
    template <class T>
    void operator()(const char*, T&) const {}
    template <class T>
    void or_null(const char*, T&) const {}
};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

}  // namespace fields_detail

template <class T>
concept HasFields = requires(T& facts) {
    std::remove_const_t<T>::fields(facts, fields_detail::Ignore{});
};

namespace fields_detail {

// Writes the fields of a struct into a JSON object, which may have other keys already.
template <class AnyJson>
class Writer {
public:
    explicit Writer(AnyJson& json) : json_(json) {}

    template <class T>
    void operator()(const char* key, const T& value) const {
        if constexpr (IsOptional<T>::value) {
            if (value) {
                json_[key] = *value;
            }
        } else {
            json_[key] = value;
        }
    }
    template <class T>
    void or_null(const char* key, const std::optional<T>& value) const {
        json_[key] = value ? AnyJson(*value) : AnyJson();
    }

private:
    AnyJson& json_;
};

// Whether a JSON value is a number that a member of type T holds without loss. The check is needed since nlohmann's
// get() turns both 1.5 and true into 1.
template <class T>
bool fits(const Json& value) {
    if constexpr (std::is_same_v<T, bool> || !std::is_arithmetic_v<T>) {
        return true;
    } else if constexpr (std::is_floating_point_v<T>) {
        return value.is_number();
    } else if (value.is_number_unsigned()) {
        return std::in_range<T>(value.get<std::uint64_t>());
    } else {
        return value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>());
    }
}

class Reader {
public:
    Reader(const Json& json, Missing missing) : json_(json), missing_(missing) {}

    template <class T>
    void operator()(const char* key, T& member) const {
        if constexpr (IsOptional<T>::value) {
            if (json_.contains(key)) {
                read(key, member.emplace());
            } else {
                member.reset();
            }
        } else if (json_.contains(key)) {
            read(key, member);
        } else if (missing_ == Missing::is_refused) {
            throw WrongFact(fmt::format("no {}", key));
        }
    }
    template <class T>
    void or_null(const char* key, std::optional<T>& member) const {
        member.reset();
        if (!json_.contains(key) || !json_.at(key).is_null()) {
            (*this)(key, member.emplace());
        }
    }

private:
    template <class T>
    void read(const char* key, T& member) const {
        const Json& value = json_.at(key);
        if (!fits<T>(value)) {
            throw WrongFact(fmt::format("{} {}", key, describe(value)));
        }
        try {
            value.get_to(member);
        } catch (const WrongFact& within) {
            throw WrongFact(fmt::format("{}: {}", key, within.what()));
        } catch (const nlohmann::detail::exception&) {
            throw WrongFact(fmt::format("{} {}", key, describe(value)));
        }
    }

    const Json& json_;
    Missing missing_;
};

}  // namespace fields_detail

// Reads a struct's fields from a JSON object and ignores keys that are no fields. Throws WrongFact.
template <class AnyJson, HasFields T>
void add_fields(AnyJson& json, const T& facts) {
    T::fields(facts, fields_detail::Writer<AnyJson>(json));
}

// Reads facts from a JSON object; keys that are no fields are left alone. Throws WrongFact.
template <HasFields T>
void read_fields(const Json& json, T& facts, Missing missing = Missing::is_refused) {
    if (!json.is_object()) {
        throw WrongFact(describe(json) + ", no object");
    }
    T::fields(facts, fields_detail::Reader(json, missing));
}

// nlohmann::json finds `to_json` and `from_json` by argument-dependent lookup in the namespace of the struct.
template <class AnyJson, HasFields T>
requires(nlohmann::detail::is_basic_json<AnyJson>::value) void to_json(AnyJson& json, const T& facts) {
    json = AnyJson::object();
    add_fields(json, facts);
}
template <HasFields T>
void from_json(const Json& json, T& facts) {
    read_fields(json, facts);
}

}  // namespace pt
