// Reads PLY, the Stanford polygon format (Turk 1994): a text header that declares elements and their properties, then
// the elements as text or binary numbers of either byte order. No library is used: Debian packages none as headers, and
// this reader can report where each fault is.
#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/failure.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/ply_header.h"
#include "harness/mesh/read_mesh.h"
#include "harness/mesh/resolution.h"
#include "harness/mesh/text_numbers.h"
#include "harness/mesh/triangulate.h"

namespace pt {

namespace {

// Reads the numbers after a PLY file's header in sequence.
class PlyNumbers {
public:
    PlyNumbers(std::string_view content, PlyFormat format, const std::string& file)
        : content_(content), format_(format), file_(file) {}

    // Sets the PLY element and its index that error messages name.
    void enter(const std::string& element, std::uint64_t index) {
        element_ = &element;
        index_ = index;
    }
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
        throw InputError(file_, fmt::format("{} {}", *element_, index_), found, allowed);
    }

    double next(PlyType type) { return format_ == PlyFormat::ascii ? next_word(type) : next_binary(type); }

    // Upper bound on the number of PLY elements of a kind that the remaining bytes of the file can hold.
    std::uint64_t most_left(const PlyElement& element) const {
        std::uint64_t bytes = 0;
        for (const PlyProperty& property : element.properties) {
            bytes += format_ == PlyFormat::ascii ? 2 : bytes_of(property.is_list ? property.count_type : property.type);
        }
        const std::uint64_t left = content_.size() - at_ + (format_ == PlyFormat::ascii ? 1 : 0);
        return left / std::max<std::uint64_t>(bytes, 1);
    }

private:
    double next_word(PlyType type) {
        constexpr std::string_view white = " \t\r\n";
        const std::size_t start = std::min(content_.find_first_not_of(white, at_), content_.size());
        const std::size_t end = std::min(content_.find_first_of(white, start), content_.size());
        const std::string_view word = content_.substr(start, end - start);
        at_ = end;
        if (word.empty()) {
            fail("the end of the file", "all elements that the header declares");
        }
        float single = 0.0f;
        double value = 0.0;
        if (!(type == PlyType::float32 ? parse_real(word, single) : parse_real(word, value))) {
            fail(excerpt(word), "a number");
        }
        if (type < PlyType::float32 && value != std::floor(value)) {
            fail(excerpt(word), "a whole number");
        }
        return type == PlyType::float32 ? single : value;
    }

    template <class T, class Bits>
    double as(const unsigned char* bytes) const {
        Bits bits = 0;
        for (std::size_t i = 0; i < sizeof(Bits); ++i) {
            const std::size_t place = format_ == PlyFormat::little_endian ? i : sizeof(Bits) - 1 - i;
            bits = static_cast<Bits>(bits | static_cast<Bits>(bytes[i]) << (8 * place));
        }
        return static_cast<double>(std::bit_cast<T>(bits));
    }

    double next_binary(PlyType type) {
        const std::size_t bytes = bytes_of(type);
        if (content_.size() - at_ < bytes) {
            fail("the end of the file", "all elements that the header declares");
        }
        const auto* from = reinterpret_cast<const unsigned char*>(content_.data() + at_);
        at_ += bytes;
        switch (type) {
            case PlyType::int8:
                return as<std::int8_t, std::uint8_t>(from);
            case PlyType::uint8:
                return as<std::uint8_t, std::uint8_t>(from);
            case PlyType::int16:
                return as<std::int16_t, std::uint16_t>(from);
            case PlyType::uint16:
                return as<std::uint16_t, std::uint16_t>(from);
            case PlyType::int32:
                return as<std::int32_t, std::uint32_t>(from);
            case PlyType::uint32:
                return as<std::uint32_t, std::uint32_t>(from);
            case PlyType::float32:
                return as<float, std::uint32_t>(from);
            default:
                return as<double, std::uint64_t>(from);
        }
    }

    std::string_view content_;
    PlyFormat format_;
    const std::string& file_;
    const std::string* element_ = nullptr;
    std::uint64_t index_ = 0;
    std::size_t at_ = 0;
};

class PlyReader {
public:
    PlyReader(std::string_view content, const std::string& file)
        : content_(content), file_(file), header_(read_ply_header(content, file)) {}

    Mesh read() {
        PlyNumbers numbers(content_.substr(header_.end), header_.format, file_);
        for (const PlyElement& element : header_.elements) {
            read_element(element, numbers);
        }
        if (!has_faces_) {
            fail_without_faces();
        }
        for (const Polygon& polygon : late_polygons_) {
            cut(polygon);
        }
        mesh_.coordinates = places_of_corners(mesh_.triangles, coordinates_);
        return std::move(mesh_);
    }

    // Largest rounding error of the mesh's vertices, found by reading the file again in double precision.
    RoundingLoss rounding_of(const Mesh& mesh) {
        if (header_.format == PlyFormat::ascii) {
            for (PlyElement& element : header_.elements) {
                for (PlyProperty& property : element.properties) {
                    property.type = property.type == PlyType::float32 ? PlyType::float64 : property.type;
                }
            }
        }
        rounded_ = &mesh;
        (void)read();
        return loss_;
    }

private:
    // A polygon of a PLY face, whose fan is stored in the mesh's triangles from `triangle` on.
    struct Polygon {
        std::size_t triangle = 0, corners = 0;
        std::uint64_t face = 0;
    };

    [[noreturn]] void fail_without_faces() const {
        std::vector<std::string> names;
        for (const PlyElement& element : header_.elements) {
            names.push_back(element.name);
        }
        throw InputError(
            file_, "header",
            fmt::format("no faces, but {}", names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "))),
            "an element \"face\" with a list \"vertex_indices\", or \"tristrips\" with one");
    }

    void cut(const Polygon& polygon) {
        std::vector<std::array<float, 3>> places;
        for (std::size_t i = 0; i < polygon.corners; ++i) {
            const auto& triangle = mesh_.triangles[polygon.triangle + (i < 3 ? 0 : i - 2)];
            const std::uint32_t vertex = triangle[std::min<std::size_t>(i, 2)];
            if (vertex >= mesh_.vertices.size()) {
                return;  // vertex index out of range, for which check_mesh refuses the mesh
            }
            places.push_back(mesh_.vertices[vertex]);
        }
        const auto [triangles, doubt] = triangulate(places);
        if (!doubt.empty()) {
            mesh_.warnings.add(fmt::format("face {}", polygon.face), doubt);
        }
        if (!triangles.empty()) {
            replace_fan(std::span(mesh_.triangles).subspan(polygon.triangle, triangles.size()), std::span(triangles));
        }
    }

    void read_element(const PlyElement& element, PlyNumbers& numbers) {
        if (element.count > 0 && element.properties.empty()) {
            throw InputError(file_, "header", fmt::format("element {} without properties", element.name),
                             "at least one");
        }
        numbers.enter(element.name, 0);
        if (element.count > numbers.most_left(element)) {
            numbers.fail(
                fmt::format("{} of them declared, and bytes for {}", element.count, numbers.most_left(element)),
                "a file as long as its header says");
        }
        if (element.name == "vertex") {
            read_vertices(element, numbers);
        } else if (element.name == "face") {
            read_faces(element, numbers);
        } else if (element.name == "tristrips" && list_of_corners(element) >= 0) {
            read_strips(element, numbers);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i) {
                numbers.enter(element.name, i);
                for (const PlyProperty& property : element.properties) {
                    pass_over(property, numbers);
                }
            }
        }
    }

    static std::uint64_t list_length(const PlyProperty& property, PlyNumbers& numbers) {
        const double length = numbers.next(property.count_type);
        if (!(length >= 0.0 && length <= 4294967295.0)) {
            numbers.fail(fmt::format("a list of {} numbers", length), "0 or more");
        }
        return static_cast<std::uint64_t>(length);
    }

    static void pass_over(const PlyProperty& property, PlyNumbers& numbers) {
        const std::uint64_t count = property.is_list ? list_length(property, numbers) : 1;
        for (std::uint64_t i = 0; i < count; ++i) {
            (void)numbers.next(property.type);
        }
    }

    // Index of a property within a PLY element by name; -1 if there is none.
    static int place_of(const PlyElement& element, std::string_view name, bool is_list) {
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (element.properties[i].name == name && element.properties[i].is_list == is_list) {
                return static_cast<int>(i);
            }
        }
        return -1;
    }

    void read_vertices(const PlyElement& element, PlyNumbers& numbers) {
        constexpr std::string_view names[] = {"x", "y", "z", "nx", "ny", "nz"};
        int places[6];
        for (int i = 0; i < 6; ++i) {
            places[i] = place_of(element, names[i], false);
            if (i < 3 && places[i] < 0) {
                throw InputError(file_, "header", fmt::format("vertices without {}", names[i]), "x, y and z");
            }
        }
        find_coordinates(element);
        const bool has_normals = places[3] >= 0 && places[4] >= 0 && places[5] >= 0;
        check_count(element, most_vertices);
        mesh_.vertices.reserve(element.count);
        mesh_.normals.reserve(has_normals ? element.count : 0);
        std::vector<double> exact(element.properties.size());
        std::vector<float> values(element.properties.size());
        for (std::uint64_t i = 0; i < element.count; ++i) {
            numbers.enter(element.name, i);
            for (std::size_t k = 0; k < values.size(); ++k) {
                if (element.properties[k].is_list) {
                    pass_over(element.properties[k], numbers);
                } else {
                    exact[k] = numbers.next(element.properties[k].type);
                    values[k] = static_cast<float>(exact[k]);
                }
            }
            mesh_.vertices.push_back({values[places[0]], values[places[1]], values[places[2]]});
            if (rounded_ != nullptr) {
                loss_.add({exact[places[0]], exact[places[1]], exact[places[2]]}, rounded_->vertices[i], i);
            }
            if (has_normals) {
                mesh_.normals.push_back({values[places[3]], values[places[4]], values[places[5]]});
            }
            if (coordinate_places_[0] >= 0) {
                coordinates_.push_back({values[coordinate_places_[0]], values[coordinate_places_[1]]});
            }
        }
    }

    // Finds the texture coordinates of a PLY vertex by the property names that exporters use.
    void find_coordinates(const PlyElement& element) {
        constexpr std::string_view names[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
        for (const auto& [u, v] : names) {
            const int u_place = place_of(element, u, false), v_place = place_of(element, v, false);
            if (u_place >= 0 && v_place >= 0) {
                coordinate_places_[0] = u_place;
                coordinate_places_[1] = v_place;
                return;
            }
        }
    }

    void check_count(const PlyElement& element, std::uint64_t most) const {
        if (element.count > most) {
            throw InputError(file_, "header", fmt::format("{} {} elements", element.count, element.name),
                             fmt::format("at most {}", most));
        }
    }

    // Index of the list of vertex indices within a PLY face element; -1 if there is none.
    static int list_of_corners(const PlyElement& element) {
        const int plural = place_of(element, "vertex_indices", true);
        return plural >= 0 ? plural : place_of(element, "vertex_index", true);
    }

    void read_faces(const PlyElement& element, PlyNumbers& numbers) {
        const int list = list_of_corners(element);
        if (list < 0) {
            throw InputError(file_, "header", "faces without vertex_indices", "a list of that name, or vertex_index");
        }
        has_faces_ = true;
        check_count(element, most_triangles);
        mesh_.triangles.reserve(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            numbers.enter(element.name, i);
            for (int k = 0; k < static_cast<int>(element.properties.size()); ++k) {
                if (k == list) {
                    read_corners(element.properties[k], numbers, i);
                } else {
                    pass_over(element.properties[k], numbers);
                }
            }
        }
    }

    static std::uint32_t next_corner(const PlyProperty& property, PlyNumbers& numbers) {
        return as_corner(numbers.next(property.type), numbers);
    }

    static std::uint32_t as_corner(double index, const PlyNumbers& numbers) {
        if (!(index >= 0.0 && index <= 4294967295.0 && index == std::floor(index))) {
            numbers.fail(fmt::format("vertex {}", index), "the number of a vertex, from 0");
        }
        return static_cast<std::uint32_t>(index);
    }

    void add_triangle(const std::array<std::uint32_t, 3>& triangle, const PlyNumbers& numbers) {
        if (mesh_.triangles.size() >= most_triangles) {
            numbers.fail("more triangles", fmt::format("at most {}", most_triangles));
        }
        mesh_.triangles.push_back(triangle);
    }

    // Reads triangle strips (Stanford's vripped scans): from the third on, each vertex forms a triangle with the two
    // before it, and -1 ends a strip.
    void read_strips(const PlyElement& element, PlyNumbers& numbers) {
        const int list = list_of_corners(element);
        has_faces_ = true;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            numbers.enter(element.name, i);
            for (int k = 0; k < static_cast<int>(element.properties.size()); ++k) {
                if (k == list) {
                    read_strip(element.properties[k], numbers);
                } else {
                    pass_over(element.properties[k], numbers);
                }
            }
        }
    }

    void read_strip(const PlyProperty& property, PlyNumbers& numbers) {
        const std::uint64_t count = list_length(property, numbers);
        std::array<std::uint32_t, 2> last{};
        std::uint64_t in_row = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const double index = numbers.next(property.type);
            if (index == -1) {
                in_row = 0;
                continue;
            }
            const std::uint32_t corner = as_corner(index, numbers);
            if (++in_row > 2) {
                add_triangle(
                    in_row % 2 == 1 ? std::array{last[0], last[1], corner} : std::array{last[1], last[0], corner},
                    numbers);
            }
            last = {last[1], corner};
        }
    }

    void read_corners(const PlyProperty& property, PlyNumbers& numbers, std::uint64_t face) {
        const std::uint64_t count = list_length(property, numbers);
        if (count < 3) {
            numbers.fail(fmt::format("{} corners", count), "at least 3");
        }
        const Polygon polygon{mesh_.triangles.size(), count, face};
        const std::uint32_t first = next_corner(property, numbers);
        std::uint32_t last = next_corner(property, numbers);
        for (std::uint64_t i = 2; i < count; ++i) {
            const std::uint32_t corner = next_corner(property, numbers);
            add_triangle({first, last, corner}, numbers);
            last = corner;
        }
        if (count > 3 && mesh_.vertices.empty()) {
            late_polygons_.push_back(polygon);  // a polygon is triangulated later if the PLY file has faces first
        } else if (count > 3) {
            cut(polygon);
        }
    }

    std::string_view content_;
    const std::string& file_;
    PlyHeader header_;
    const Mesh* rounded_ = nullptr;
    RoundingLoss loss_;
    std::vector<Polygon> late_polygons_;
    Mesh mesh_;
    int coordinate_places_[2] = {-1, -1};
    std::vector<std::array<float, 2>> coordinates_;  // texture coordinates of the PLY file by vertex
    bool has_faces_ = false;
};

}  // namespace

Mesh parse_ply(std::string_view content, const std::string& file) {
    Mesh mesh = PlyReader(content, file).read();
    check_mesh(mesh, file);
    if (may_have_lost_digits(mesh)) {
        const RoundingLoss loss = PlyReader(content, file).rounding_of(mesh);
        if (const auto warning = resolution_warning(mesh, loss.largest())) {
            mesh.warnings.add(fmt::format("vertex {}", loss.place()), *warning);
        }
    }
    return mesh;
}

}  // namespace pt
