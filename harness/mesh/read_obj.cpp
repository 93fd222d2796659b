// Reads Wavefront OBJ files (Advanced Visualizer manual, appendix B1): vertices, normals, texture coordinates and
// faces; other shapes are skipped with a warning. tinyobjloader 2.0.0 is not used: it reads "v nan 0 x" as the origin,
// drops faces with bad indices, and reports no line numbers.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/obj_keywords.h"
#include "harness/mesh/obj_materials.h"
#include "harness/mesh/read_mesh.h"
#include "harness/mesh/resolution.h"
#include "harness/mesh/text_numbers.h"
#include "harness/mesh/triangulate.h"
#include "harness/words.h"

namespace pt {

namespace {

struct ObjCorner {
    std::uint32_t vertex = 0, normal = 0, texture = 0;
    bool has_normal = false, has_texture = false;
};

class ObjReader {
public:
    ObjReader(std::string_view content, const std::string& file) : content_(content), file_(file) {}

    Mesh read() {
        read_lines();
        give_normals();
        return std::move(mesh_);
    }

    ObjParts read_parts() {
        keeps_parts_ = true;
        read_lines();
        found_.mesh = std::move(mesh_);
        return std::move(found_);
    }

private:
    void read_lines() {
        while (next_line()) {
            read_line();
        }
        check_pending(pending_vertex_, mesh_.vertices.size(), "vertex");
        check_pending(pending_normal_, normals_.size(), "normal");
        for (const LatePolygon& polygon : late_polygons_) {
            cut_polygon(polygon.triangle, polygon.corners, polygon.line);
        }
        check_resolution();
        if (all_have_texture_) {
            mesh_.coordinates = places_of_corners(texture_triangles_, textures_);
        }
    }

    // Largest vertex or normal index in OBJ faces so far, and its line: checked at the end, as vertices may come later.
    struct Pending {
        std::uint64_t count = 0;
        std::size_t line = 0;
    };

    // A polygon that refers to a vertex defined later in the file, so that it is triangulated at the end.
    struct LatePolygon {
        std::size_t triangle = 0, corners = 0, line = 0;
    };

    [[noreturn]] void fail(std::size_t line, const std::string& found, const std::string& allowed) const {
        throw InputError(file_, fmt::format("line {}", line), found, allowed);
    }

    void check_pending(const Pending& pending, std::size_t count, const std::string& what) const {
        if (pending.count > count) {
            fail(pending.line, fmt::format("{} {}", what, pending.count),
                 count == 0 ? "none: the file has none" : fmt::format("1 to {}, or -1 to -{}", count, count));
        }
    }

    void warn(std::size_t line, std::string_view text) { mesh_.warnings.add(fmt::format("line {}", line), text); }

    // Advances to the next OBJ line, joined with those after it while it ends in a backslash; false at the file's end.
    bool next_line() {
        if (at_ >= content_.size()) {
            return false;
        }
        line_ += lines_joined_ + 1;
        lines_joined_ = 0;
        text_ = physical_line();
        if (!joins_next_line(text_)) {
            return true;
        }
        joined_.clear();
        while (text_.ends_with('\\') && text_.find('#') == std::string_view::npos && at_ < content_.size()) {
            joined_ += text_.substr(0, text_.size() - 1);
            joined_ += ' ';
            text_ = physical_line();
            ++lines_joined_;
        }
        joined_ += text_;
        text_ = joined_;
        return true;
    }

    std::string_view physical_line() {
        const std::size_t end = std::min(content_.find('\n', at_), content_.size());
        std::string_view line = content_.substr(at_, end - at_);
        at_ = end + 1;
        while (line.ends_with('\r') || line.ends_with(' ')) {
            line.remove_suffix(1);
        }
        return line;
    }

    // Takes the next word from the current OBJ line; empty at the line's end.
    std::string_view next_word() {
        const std::size_t start = std::min(text_.find_first_not_of(obj_white), text_.size());
        const std::size_t end = std::min(text_.find_first_of(obj_white, start), text_.size());
        const std::string_view word = text_.substr(start, end - start);
        text_.remove_prefix(end);
        return word;
    }

    void read_line() {
        if (!is_obj_name(obj_line_of(first_obj_word(text_)))) {
            text_ = text_.substr(0, text_.find('#'));
        }
        const std::string_view line = text_, word = next_word();
        const ObjLine kind = obj_line_of(word);
        switch (kind) {
            case ObjLine::vertex:
                check_room(mesh_.vertices.size(), most_vertices, "vertices");
                mesh_.vertices.push_back(read_triple<float>(line));
                break;
            case ObjLine::normal:
                check_room(normals_.size(), most_vertices, "normals");
                normals_.push_back(read_triple<float>(line));
                break;
            case ObjLine::texture:
                read_texture();
                break;
            case ObjLine::face:
                read_face(line);
                break;
            default:
                if (!word.empty()) {
                    read_other(kind, word);
                }
        }
    }

    void read_other(ObjLine kind, std::string_view word) {
        if (const std::string remark = obj_remark(kind, word); !remark.empty()) {
            warn(line_, remark);
        } else if (!keeps_parts_) {
            return;  // names of materials and groups matter only if the OBJ mesh is split into parts
        } else if (kind == ObjLine::material || kind == ObjLine::group) {
            (kind == ObjLine::material ? current_.material : current_.group) = rest_of_line();
            has_current_ = false;
        } else if (kind == ObjLine::library) {
            const std::size_t start = std::min(text_.find_first_not_of(" \t"), text_.size());
            found_.libraries.emplace_back(text_.substr(start));  // an MTL library's file name may contain spaces
        } else if (kind == ObjLine::image && rest_of_line() != "off") {
            warn(line_, fmt::format("{} is passed over: images are those of the materials", word));
        }
    }

    // Warns of vertices that lost digits in single precision; reads the file again in double if coordinates are large.
    void check_resolution() {
        if (!may_have_lost_digits(mesh_)) {
            return;
        }
        RoundingLoss loss;
        at_ = line_ = lines_joined_ = 0;
        for (std::size_t vertex = 0; next_line();) {
            text_ = text_.substr(0, text_.find('#'));
            const std::string_view line = text_;
            if (next_word() == "v") {
                loss.add(read_triple<double>(line), mesh_.vertices[vertex++], line_);
            }
        }
        if (const auto warning = resolution_warning(mesh_, loss.largest())) {
            warn(loss.place(), *warning);
        }
    }

    // Triangulates a polygon of `corners` corners again, in place of its fan in the mesh's triangles from `first` on.
    void cut_polygon(std::size_t first, std::size_t corners, std::size_t line) {
        std::vector<std::array<float, 3>> places;
        for (std::size_t i = 0; i < corners; ++i) {
            const std::array<std::uint32_t, 3>& triangle = mesh_.triangles[first + (i < 3 ? 0 : i - 2)];
            places.push_back(mesh_.vertices[triangle[std::min<std::size_t>(i, 2)]]);
        }
        const auto [triangles, doubt] = triangulate(places);
        if (!doubt.empty()) {
            warn(line, doubt);
        }
        if (triangles.empty()) {
            return;
        }
        for (auto* indices : {&mesh_.triangles, &normal_triangles_, &texture_triangles_}) {
            if (first + triangles.size() <= indices->size()) {
                replace_fan(std::span(*indices).subspan(first, triangles.size()), std::span(triangles));
            }
        }
    }

    // Takes the rest of the OBJ line as a name; runs of spaces in it become one space.
    std::string rest_of_line() {
        std::string rest(next_word());
        for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            rest += ' ';
            rest += word;
        }
        return rest;
    }

    // Index of the part (material and group) that the next faces belong to; adds the part if it is new.
    std::uint32_t part() {
        if (!has_current_) {
            const auto [place, is_new] = part_numbers_.try_emplace({current_.material, current_.group},
                                                                   static_cast<std::uint32_t>(found_.parts.size()));
            if (is_new) {
                found_.parts.push_back(current_);
            }
            current_number_ = place->second;
            has_current_ = true;
        }
        return current_number_;
    }

    void check_room(std::size_t count, std::uint64_t most, const std::string& what) const {
        if (count >= most) {
            fail(line_, fmt::format("more {}", what), fmt::format("at most {}", most));
        }
    }

    // Reads three numbers of an OBJ line and ignores what follows, such as a weight or a colour.
    template <class T>
    std::array<T, 3> read_triple(std::string_view line) {
        std::array<T, 3> triple;
        for (T& number : triple) {
            if (!parse_real(next_word(), number)) {
                fail(line_, excerpt(line), "3 numbers");
            }
        }
        return triple;
    }

    void read_face(std::string_view line) {
        corners_.clear();
        for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            corners_.push_back(read_corner(word));
        }
        if (corners_.size() < 3) {
            fail(line_, excerpt(line), "a face with at least 3 corners");
        }
        const std::size_t first = mesh_.triangles.size();
        bool is_late = false;
        for (std::size_t i = 2; i < corners_.size(); ++i) {
            check_room(mesh_.triangles.size(), most_triangles, "triangles");
            mesh_.triangles.push_back({corners_[0].vertex, corners_[i - 1].vertex, corners_[i].vertex});
            if (keeps_parts_) {
                found_.part_of.push_back(part());
            }
            for (const ObjCorner& corner : {corners_[0], corners_[i - 1], corners_[i]}) {
                all_have_normals_ = all_have_normals_ && corner.has_normal;
                all_have_texture_ = all_have_texture_ && corner.has_texture;
                is_late = is_late || corner.vertex >= mesh_.vertices.size();
            }
            if (all_have_normals_) {
                normal_triangles_.push_back({corners_[0].normal, corners_[i - 1].normal, corners_[i].normal});
            }
            if (all_have_texture_) {
                texture_triangles_.push_back({corners_[0].texture, corners_[i - 1].texture, corners_[i].texture});
            }
        }
        if (corners_.size() > 3 && is_late) {
            late_polygons_.push_back({first, corners_.size(), line_});
        } else if (corners_.size() > 3) {
            cut_polygon(first, corners_.size(), line_);
        }
    }

    // Parses a corner of an OBJ face: V, V/T, V//N or V/T/N.
    ObjCorner read_corner(std::string_view word) {
        const std::size_t first = std::min(word.find('/'), word.size());
        const std::size_t second = std::min(word.find('/', first + 1), word.size());
        ObjCorner corner;
        corner.vertex = read_index(word, word.substr(0, first), mesh_.vertices.size(), pending_vertex_);
        if (first < second) {
            read_texture_index(word.substr(first + 1, second - first - 1), corner);
        }
        corner.has_normal = second < word.size();
        if (corner.has_normal) {
            corner.normal = read_index(word, word.substr(second + 1), normals_.size(), pending_normal_);
        }
        return corner;
    }

    // Reads a texture coordinate. If any is unreadable, all are dropped silently, since most scenes show no texture.
    void read_texture() {
        std::array<float, 2> at{};
        const std::string_view u = next_word(), v = next_word();
        all_have_texture_ = all_have_texture_ && textures_.size() < most_vertices && parse_real(u, at[0]) &&
                            (v.empty() || parse_real(v, at[1]));
        if (all_have_texture_) {
            textures_.push_back(at);
        }
    }

    void read_texture_index(std::string_view number, ObjCorner& corner) const {
        const std::int64_t index = parse_number<std::int64_t>(number).value_or(0);
        const std::int64_t place = index > 0 ? index - 1 : index + static_cast<std::int64_t>(textures_.size());
        corner.has_texture = index != 0 && place >= 0 && place < static_cast<std::int64_t>(most_vertices);
        corner.texture = corner.has_texture ? static_cast<std::uint32_t>(place) : 0;
    }

    // Parses an OBJ index, which counts from 1, or backward from -1, and returns it counted from 0.
    std::uint32_t read_index(std::string_view word, std::string_view number, std::size_t count,
                             Pending& pending) const {
        const std::int64_t index = parse_number<std::int64_t>(number).value_or(0);
        if (index == 0 || index > 0xffffffff) {
            fail(line_, excerpt(word), "V, V/T, V//N or V/T/N, whole numbers from 1, or from -1 backward");
        }
        if (index < 0 && index + static_cast<std::int64_t>(count) < 0) {
            fail(line_, excerpt(word), fmt::format("-1 to -{}: so many there are before this line", count));
        }
        if (index > 0 && static_cast<std::uint64_t>(index) > pending.count) {
            pending = {static_cast<std::uint64_t>(index), line_};
        }
        return static_cast<std::uint32_t>(index > 0 ? index - 1 : index + static_cast<std::int64_t>(count));
    }

    // Gives the mesh vertex normals. A vertex with several normals is split. If a corner has none, the mesh has none.
    void give_normals() {
        if (normal_triangles_.empty() || !all_have_normals_) {
            return;
        }
        if (normals_.size() == mesh_.vertices.size() && mesh_.triangles == normal_triangles_) {
            mesh_.normals = std::move(normals_);
            return;
        }
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> vertex_of;
        std::vector<std::array<float, 3>> vertices;
        for (std::size_t i = 0; i < 3 * normal_triangles_.size(); ++i) {
            std::uint32_t& corner = mesh_.triangles[i / 3][i % 3];
            const std::uint32_t normal = normal_triangles_[i / 3][i % 3];
            const auto [place, is_new] =
                vertex_of.try_emplace({corner, normal}, static_cast<std::uint32_t>(vertices.size()));
            if (is_new) {
                vertices.push_back(mesh_.vertices[corner]);
                mesh_.normals.push_back(normals_[normal]);
            }
            corner = place->second;
        }
        mesh_.vertices = std::move(vertices);
    }

    std::string_view content_;
    const std::string& file_;
    std::size_t at_ = 0, line_ = 0, lines_joined_ = 0;
    std::string_view text_;  // part of the current OBJ line that has not been read yet
    std::string joined_;
    std::vector<ObjCorner> corners_;  // corners of the current OBJ face
    std::vector<std::array<float, 3>> normals_;
    std::vector<std::array<std::uint32_t, 3>> normal_triangles_;  // each triangle corner's index into normals_
    bool all_have_normals_ = true;
    std::vector<std::array<float, 2>> textures_;
    std::vector<std::array<std::uint32_t, 3>> texture_triangles_;  // each triangle corner's index into textures_
    bool all_have_texture_ = true;
    Pending pending_vertex_, pending_normal_;
    std::vector<LatePolygon> late_polygons_;
    Mesh mesh_;
    bool keeps_parts_ = false, has_current_ = false;
    ObjPart current_;
    std::uint32_t current_number_ = 0;
    std::map<std::pair<std::string, std::string>, std::uint32_t> part_numbers_;
    ObjParts found_;
};

}  // namespace

Mesh parse_obj(std::string_view content, const std::string& file) {
    Mesh mesh = ObjReader(content, file).read();
    check_mesh(mesh, file);
    return mesh;
}

ObjParts parse_obj_parts(std::string_view content, const std::string& file) {
    return ObjReader(content, file).read_parts();
}

Mesh part_of_mesh(const Mesh& mesh, const std::vector<bool>& is_in) {
    Mesh part;
    constexpr std::uint32_t none = 0xffffffff;
    std::vector<std::uint32_t> numbers(mesh.vertices.size(), none);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (!is_in[i]) {
            continue;
        }
        auto& triangle = part.triangles.emplace_back(mesh.triangles[i]);
        for (std::uint32_t& corner : triangle) {
            if (numbers[corner] == none) {
                numbers[corner] = static_cast<std::uint32_t>(part.vertices.size());
                part.vertices.push_back(mesh.vertices[corner]);
            }
            corner = numbers[corner];
        }
        if (!mesh.coordinates.empty()) {
            part.coordinates.push_back(mesh.coordinates[i]);
        }
    }
    return part;
}

}  // namespace pt
