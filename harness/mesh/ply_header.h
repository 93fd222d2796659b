// The header of a PLY file: the declared elements in file order, each with its properties.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pt {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool is_list = false;
    PlyType count_type = PlyType::uint8;  // PLY type of the count before a list's values
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t end = 0;  // offset in bytes at which the PLY elements begin
};

std::size_t bytes_of(PlyType type);

// Reads the header of a PLY file. Throws InputError with the line number if it is invalid; `file` is the name that
// error messages show.
PlyHeader read_ply_header(std::string_view content, const std::string& file);

}  // namespace pt
