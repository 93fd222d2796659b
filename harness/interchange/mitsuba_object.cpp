#include "harness/interchange/mitsuba_object.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/words.h"

namespace pt {

std::optional<std::vector<double>> mitsuba_numbers(const std::string& text) {
    constexpr const char* between = ", \t\r\n";
    std::vector<double> numbers;
    for (std::size_t start = text.find_first_not_of(between); start != std::string::npos;) {
        const std::size_t end = std::min(text.find_first_of(between, start), text.size());
        const std::optional<double> number = parse_finite(std::string_view(text).substr(start, end - start));
        if (!number) {
            return std::nullopt;
        }
        numbers.push_back(*number);
        start = text.find_first_not_of(between, end);
    }
    return numbers;
}

void MitsubaObject::fail(const XmlElement& element, const std::string& allowed) {
    is_good_ = false;
    file_->refuse(element, allowed);
}

const XmlElement* MitsubaObject::property(const std::string& name) {
    const XmlElement* found = nullptr;
    for (const XmlElement& child : element_->children) {
        if (child.value_of("name") != name) {
            continue;
        }
        if (found != nullptr) {
            fail(child, fmt::format("one \"{}\"", name));
        }
        asked_.insert(&child);
        found = &child;
    }
    return found;
}

std::vector<const XmlElement*> MitsubaObject::objects(const std::string& tag) {
    std::vector<const XmlElement*> found;
    for (const XmlElement& child : element_->children) {
        const XmlElement* object = &child;
        if (child.tag == "ref") {
            const auto known = file_->by_id.find(child.value_of("id"));
            object = known == file_->by_id.end() ? nullptr : known->second;
        }
        if (object != nullptr && object->tag == tag) {
            asked_.insert(&child);
            found.push_back(object);
        }
    }
    return found;
}

void MitsubaObject::ignore(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        (void)property(name);
    }
}

void MitsubaObject::refuse_property(const std::string& name, const std::string& allowed) {
    if (const XmlElement* found = property(name)) {
        fail(*found, allowed);
    }
}

std::optional<double> MitsubaObject::optional_number(const std::string& name) {
    const XmlElement* found = property(name);
    if (found == nullptr) {
        return std::nullopt;
    }
    const auto numbers = mitsuba_numbers(found->value_of("value"));
    if ((found->tag != "float" && found->tag != "integer") || !numbers || numbers->size() != 1) {
        fail(*found, fmt::format("<float name=\"{}\"> with 1 finite number", name));
        return std::nullopt;
    }
    return numbers->front();
}

double MitsubaObject::number(const std::string& name, double otherwise) {
    return optional_number(name).value_or(otherwise);
}

bool MitsubaObject::boolean(const std::string& name, bool otherwise) {
    const XmlElement* found = property(name);
    if (found == nullptr) {
        return otherwise;
    }
    const std::string value = in_lower_case(found->value_of("value"));
    if (found->tag != "boolean" || (value != "true" && value != "false")) {
        fail(*found, fmt::format("<boolean name=\"{}\"> with true or false", name));
    }
    return value == "true";
}

std::string MitsubaObject::text(const std::string& name, const std::string& otherwise) {
    const XmlElement* found = property(name);
    if (found == nullptr) {
        return otherwise;
    }
    if (found->tag != "string") {
        fail(*found, fmt::format("<string name=\"{}\">", name));
    }
    return found->value_of("value");
}

std::optional<Vec3d> MitsubaObject::optional_colour(const std::string& name) {
    const XmlElement* found = property(name);
    if (found == nullptr) {
        return std::nullopt;
    }
    const auto numbers = mitsuba_numbers(found->value_of("value"));
    const bool is_rgb = found->tag == "rgb", is_grey = found->tag == "spectrum" || found->tag == "float";
    const bool is_good = numbers && ((numbers->size() == 3 && is_rgb) || (numbers->size() == 1 && (is_rgb || is_grey)));
    if (!is_good) {
        fail(*found, fmt::format("<rgb name=\"{0}\"> with 1 or 3 numbers, or a <spectrum name=\"{0}\"> with 1: no "
                                 "wavelengths, and textures of reflectances alone",
                                 name));
        return std::nullopt;
    }
    return numbers->size() == 3 ? Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]) : Vec3d(numbers->front());
}

std::optional<Vec3d> MitsubaObject::optional_radiance(const std::string& name) {
    std::optional<Vec3d> radiance = optional_colour(name);
    const XmlElement* found = property(name);
    if (radiance && found->tag == "spectrum") {
        // Mitsuba's constant spectrum has equal energy everywhere, XYZ (1, 1, 1), here in linear sRGB (IEC 61966-2-1).
        const Vec3d equal_energy{3.240479 - 1.537150 - 0.498535, -0.969256 + 1.875991 + 0.041556,
                                 0.055648 - 0.204043 + 1.057311};
        *radiance = *radiance * equal_energy;
        file_->note(*found, fmt::format("is a spectrum: [{:.6g}, {:.6g}, {:.6g}], as Mitsuba's RGB variants have it",
                                        radiance->x, radiance->y, radiance->z));
    }
    return radiance;
}

Vec3d MitsubaObject::colour(const std::string& name, const Vec3d& otherwise) {
    return optional_colour(name).value_or(otherwise);
}

// Reads a vector from the attributes "x", "y" and "z", or from "value" with 1 or 3 numbers.
Vec3d MitsubaObject::vector_of(const XmlElement& element, double otherwise) {
    Vec3d vector(otherwise);
    if (const std::string* value = element.attribute("value")) {
        const auto numbers = mitsuba_numbers(*value);
        if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) {
            fail(element, "1 or 3 finite numbers");
            return vector;
        }
        return numbers->size() == 1 ? Vec3d(numbers->front()) : Vec3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    }
    const char* names[3] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (const std::string* value = element.attribute(names[axis])) {
            const auto numbers = mitsuba_numbers(*value);
            if (!numbers || numbers->size() != 1) {
                fail(element, fmt::format("1 finite number in \"{}\"", names[axis]));
                return vector;
            }
            vector[axis] = numbers->front();
        }
    }
    return vector;
}

Vec3d MitsubaObject::point(const std::string& name, const Vec3d& otherwise) {
    const XmlElement* found = property(name);
    if (found != nullptr && found->tag != "point" && found->tag != "vector") {
        fail(*found, fmt::format("<point name=\"{}\">", name));
        return otherwise;
    }
    return found == nullptr ? otherwise : vector_of(*found, 0);
}

Affine look_at_map(const Vec3d& origin, const Vec3d& target, const Vec3d& up) {
    const auto unit = [](const Vec3d& v) { return v * (1 / std::sqrt(dot(v, v))); };
    const Vec3d forward = unit(target - origin), left = unit(cross(up, forward));
    Affine map;
    map.column[0] = left;
    map.column[1] = cross(forward, left);
    map.column[2] = forward;
    map.origin = origin;
    return map;
}

Affine MitsubaObject::transform_of(const XmlElement& step) {
    const auto three = [&](const char* name) -> Vec3d {
        const auto numbers = mitsuba_numbers(step.value_of(name));
        if (!numbers || numbers->size() != 3) {
            fail(step, fmt::format("3 finite numbers in \"{}\"", name));
            return Vec3d(0.0);
        }
        return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    };
    if (step.tag == "translate") {
        return translation(vector_of(step, 0));
    }
    if (step.tag == "scale") {
        return scaling(vector_of(step, 1));
    }
    if (step.tag == "rotate") {
        const Vec3d axis = vector_of(step, 0);
        const auto angle = mitsuba_numbers(step.value_of("angle"));
        if (is_black(axis) || !angle || angle->size() != 1) {
            fail(step, "an axis that is not 0, and an angle in degrees");
            return {};
        }
        constexpr double slight = 1e-3;
        if (std::abs(dot(axis, axis) - 1) > slight) {
            file_->warn(step,
                        "turns about an axis that is not of length 1: here it turns all the same, where Mitsuba 3 "
                        "shears");
        }
        return rotation_about(axis, angle->front());
    }
    if (step.tag == "lookat") {
        const Vec3d origin = three("origin"), target = three("target");
        const Vec3d up = step.attribute("up") == nullptr ? Vec3d(0.0) : three("up");
        const Vec3d across = cross(up, target - origin);
        if (!(dot(across, across) > 0)) {
            fail(step, "an origin, a target elsewhere, and a direction up that is not towards it");
            return {};
        }
        return look_at_map(origin, target, up);
    }
    const auto numbers = mitsuba_numbers(step.value_of("value"));
    if (step.tag != "matrix" || !numbers || (numbers->size() != 9 && numbers->size() != 16)) {
        fail(step, "translate, scale, rotate, lookat, or matrix with 9 or 16 finite numbers");
        return {};
    }
    const std::size_t side = numbers->size() == 9 ? 3 : 4;
    const auto entry = [&](std::size_t row, std::size_t column) { return (*numbers)[row * side + column]; };
    Affine map;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            map.column[column][row] = entry(row, column);
        }
        map.origin[row] = side == 4 ? entry(row, 3) : 0;
    }
    const bool is_affine = side == 3 || (entry(3, 0) == 0 && entry(3, 1) == 0 && entry(3, 2) == 0 && entry(3, 3) == 1);
    if (!is_affine) {
        fail(step, "a matrix whose last row is 0 0 0 1");
    }
    return map;
}

// Reads the transform of a Mitsuba object: steps such as <translate>, applied in the order of the file.
Affine MitsubaObject::transform(const std::string& name) {
    const XmlElement* found = property(name);
    Affine map;
    if (found == nullptr) {
        return map;
    }
    if (found->tag != "transform") {
        fail(*found, fmt::format("<transform name=\"{}\">", name));
        return map;
    }
    bool is_first = true;
    for (const XmlElement& step : found->children) {
        // The first transform step's matrix is not multiplied by the identity, so that all its bits are kept.
        map = is_first ? transform_of(step) : transform_of(step) * map;
        is_first = false;
    }
    return map;
}

void MitsubaObject::finish(const std::string& known) {
    for (const XmlElement& child : element_->children) {
        if (!asked_.contains(&child)) {
            fail(child, known);
        }
    }
}

}  // namespace pt
