#include "harness/scene/environment_image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "harness/exr.h"
#include "harness/json_reader.h"

namespace pt {

namespace {

constexpr std::uint64_t largest_environment_file = std::uint64_t{1} << 30;

void check_environment_size(long long width, long long height, const std::string& file) {
    if (width < 1 || height < 1 || width > most_environment_columns || height > most_environment_rows) {
        throw InputError(file, "size", fmt::format("{} x {} texels", width, height),
                         fmt::format("1 x 1 to {} x {}", most_environment_columns, most_environment_rows));
    }
}

void check_environment_texels(const EnvironmentImage& image, const std::string& file) {
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            const float value = image.texels[i][channel];
            if (!(value >= 0 && value <= 1e30f)) {
                throw InputError(file, fmt::format("texel {}, {}", i % image.width, i / image.width),
                                 fmt::format("{}", value), "a number from 0 to 1e30");
            }
        }
    }
}

// Reads Radiance .hdr files. Texels are Ward's RGBE: three 8-bit mantissas and a shared exponent (Graphics Gems II,
// chapter II.5), rows from the top, each uncompressed or run-length encoded by channel. Factors that EXPOSURE and
// COLORCORR lines give are divided out (like Radiance's pvalue -o). stb_image would not notice a truncated file.
class HdrReader {
public:
    HdrReader(std::string_view content, const std::string& file) : content_(content), file_(file) {}

    EnvironmentImage read() {
        read_header();
        EnvironmentImage image{.width = width_, .height = height_, .texels = {}};
        image.texels.reserve(std::min(std::size_t{width_} * height_, content_.size()));
        for (std::uint32_t row = 0; row < height_; ++row) {
            read_row(image.texels);
        }
        image.was_multiplied = factors_ != std::array{1.0, 1.0, 1.0};
        if (image.was_multiplied) {
            divide(image.texels);
        }
        check_environment_texels(image, file_);
        return image;
    }

private:
    [[noreturn]] void refuse(const std::string& found) const {
        throw InputError(file_, "content", found,
                         "a whole Radiance image: #?RADIANCE, FORMAT=32-bit_rle_rgbe, -Y HEIGHT +X WIDTH, texels");
    }
    std::string_view line() {
        const std::size_t end = content_.find('\n', place_);
        if (end == std::string_view::npos || end - place_ > 1024) {
            refuse("no header");
        }
        const std::string_view text = content_.substr(place_, end - place_);
        place_ = end + 1;
        return text.ends_with('\r') ? text.substr(0, text.size() - 1) : text;
    }
    void read_header() {
        if (!line().starts_with("#?")) {
            refuse("no #?RADIANCE at its beginning");
        }
        for (std::string_view text = line(); !text.empty(); text = line()) {
            read_variable(text);
        }
        read_size(line());
    }
    // Parses the numbers of an .hdr header line NAME=..; returns none unless there are exactly `count` numbers.
    static std::vector<double> numbers_in(std::string_view text, std::size_t count) {
        std::vector<double> numbers;
        text.remove_prefix(text.find('=') + 1);
        while (true) {
            text.remove_prefix(std::min(text.find_first_not_of(" \t+"), text.size()));
            double number = 0;
            const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (failed != std::errc()) {
                return text.empty() && numbers.size() == count ? numbers : std::vector<double>();
            }
            numbers.push_back(number);
            text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        }
    }
    // Handles a line NAME=VALUE of the .hdr header. An indented line describes an image that this one was derived from.
    void read_variable(std::string_view text) {
        const auto refuse_line = [&](const std::string& allowed) {
            throw InputError(file_, "header", fmt::format("\"{}\"", text), allowed);
        };
        if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe") {
            refuse(fmt::format("\"{}\"", text));
        } else if (text.starts_with("EXPOSURE=")) {
            const std::vector<double> factor = numbers_in(text, 1);
            if (factor.empty() || !multiply({factor[0], factor[0], factor[0]})) {
                refuse_line("EXPOSURE= and a number from 1e-30 to 1e30");
            }
        } else if (text.starts_with("COLORCORR=")) {
            const std::vector<double> factor = numbers_in(text, 3);
            if (factor.empty() || !multiply({factor[0], factor[1], factor[2]})) {
                refuse_line("COLORCORR= and three numbers from 1e-30 to 1e30");
            }
        } else if (text.starts_with("GAMMA=") && numbers_in(text, 1) != std::vector{1.0}) {
            refuse_line("no GAMMA, or 1: numbers in proportion to light");
        } else if (text.starts_with("PRIMARIES=") && !has_known_primaries(text)) {
            refuse_line("no PRIMARIES, or those of Radiance or sRGB");
        } else if (text.starts_with("VIEW=")) {
            refuse_line("no VIEW: an equirectangular image of all round, which no view of Radiance is");
        }
    }
    // Records a factor (EXPOSURE or COLORCORR) of an .hdr file's texels. Returns false if it cannot be divided out.
    bool multiply(const std::array<double, 3>& factor) {
        bool is_good = true;
        for (std::size_t i = 0; i < 3; ++i) {
            factors_[i] *= factor[i];
            is_good = is_good && factor[i] > 0 && factors_[i] >= 1e-30 && factors_[i] <= 1e30;
        }
        return is_good;
    }
    void divide(std::vector<Vec3<float>>& texels) const {
        for (Vec3<float>& texel : texels) {
            for (int i = 0; i < 3; ++i) {
                texel[i] = static_cast<float>(double{texel[i]} / factors_[static_cast<std::size_t>(i)]);
            }
        }
    }
    // Whether an .hdr file's PRIMARIES are Radiance's or sRGB's: x and y each of red, green, blue and white.
    static bool has_known_primaries(std::string_view text) {
        constexpr double slight = 2e-3;
        const std::vector<double> is = numbers_in(text, 8);
        const auto are = [&](const std::array<double, 8>& known) {
            return is.size() == 8 && std::equal(is.begin(), is.end(), known.begin(),
                                                [](double a, double b) { return std::abs(a - b) < slight; });
        };
        return are({0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 1.0 / 3, 1.0 / 3}) ||
               are({0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329});
    }
    void read_size(std::string_view size) {
        const char* const end = size.data() + size.size();
        long long height = -1, width = -1;
        constexpr std::string_view between = " +X ";
        if (!size.starts_with("-Y ")) {
            refuse(fmt::format("\"{}\"", size));
        }
        const char* const after = std::from_chars(size.data() + 3, end, height).ptr;
        if (!std::string_view(after, end).starts_with(between) ||
            std::from_chars(after + between.size(), end, width).ptr != end) {
            refuse(fmt::format("\"{}\"", size));
        }
        check_environment_size(width, height, file_);
        width_ = static_cast<std::uint32_t>(width);
        height_ = static_cast<std::uint32_t>(height);
    }
    std::uint32_t byte() {
        if (place_ >= content_.size()) {
            refuse("a file that ends early");
        }
        return static_cast<unsigned char>(content_[place_++]);
    }
    // Whether the next row of the .hdr file is run-length encoded: such a row begins with 2, 2 and its width.
    bool takes_run_head() {
        if (width_ < 8 || content_.size() - place_ < 4) {
            return false;
        }
        const std::string head{2, 2, static_cast<char>(width_ >> 8), static_cast<char>(width_ & 0xff)};
        const bool is_by_runs = content_.substr(place_, 4) == head;
        place_ += is_by_runs ? 4 : 0;
        return is_by_runs;
    }
    void read_row(std::vector<Vec3<float>>& texels) {
        std::vector<std::uint32_t> bytes(std::size_t{4} * width_);
        if (takes_run_head()) {
            for (std::size_t channel = 0; channel < 4; ++channel) {
                read_runs(bytes, channel);
            }
        } else {
            read_texels(bytes);
        }
        for (std::size_t i = 0; i < bytes.size(); i += 4) {
            const int exponent = static_cast<int>(bytes[i + 3]) - 136;
            const float scale = bytes[i + 3] == 0 ? 0.0f : std::ldexp(1.0f, exponent);
            texels.emplace_back(static_cast<float>(bytes[i]) * scale, static_cast<float>(bytes[i + 1]) * scale,
                                static_cast<float>(bytes[i + 2]) * scale);
        }
    }
    // Reads a row texel by texel, with the format's older run lengths: 1, 1, 1, n repeats the previous texel n times,
    // and a second such code right after it 256 n times.
    void read_texels(std::vector<std::uint32_t>& bytes) {
        std::size_t unit = 1;
        for (std::size_t place = 0; place < bytes.size();) {
            std::uint32_t texel[4];
            for (std::uint32_t& value : texel) {
                value = byte();
            }
            const bool is_run = texel[0] == 1 && texel[1] == 1 && texel[2] == 1;
            const std::size_t count = is_run ? texel[3] * unit : 1;
            if (4 * count > bytes.size() - place || (is_run && place == 0)) {
                refuse("a run beyond its row");
            }
            for (std::size_t i = 0; i < 4 * count; ++i, ++place) {
                bytes[place] = is_run ? bytes[place - 4] : texel[i];
            }
            unit = is_run ? std::min<std::size_t>(unit * 256, std::size_t{1} << 24) : 1;
        }
    }
    void read_runs(std::vector<std::uint32_t>& bytes, std::size_t channel) {
        std::size_t column = 0;
        while (column < width_) {
            const std::uint32_t code = byte();
            const bool repeats = code > 128;
            const std::size_t count = repeats ? code - 128 : code;
            if (count == 0 || count > width_ - column) {
                refuse("a run beyond its row");
            }
            std::uint32_t value = repeats ? byte() : 0;
            for (std::size_t i = 0; i < count; ++i, ++column) {
                value = repeats ? value : byte();
                bytes[4 * column + channel] = value;
            }
        }
    }

    std::string_view content_;
    const std::string& file_;
    std::size_t place_ = 0;
    std::uint32_t width_ = 0, height_ = 0;
    std::array<double, 3> factors_{1, 1, 1};
};

}  // namespace

EnvironmentImage parse_hdr(std::string_view content, const std::string& file) {
    return HdrReader(content, file).read();
}

EnvironmentImage parse_exr(std::string_view content, const std::string& file) {
    if (!has_openexr()) {
        throw InputError(file, "file name", "the ending .exr, which this build cannot read (libopenexr-dev)", ".hdr");
    }
    const auto [size, data] = exr_windows(content, file);
    check_environment_size(size.width, size.height, file);
    check_environment_size(data.width, data.height, file);
    EnvironmentImage image{.width = static_cast<std::uint32_t>(size.width),
                           .height = static_cast<std::uint32_t>(size.height),
                           .texels = {}};
    const std::vector<float> values = decode_exr(content, file);
    for (std::size_t i = 0; i < values.size(); i += 3) {
        image.texels.emplace_back(values[i], values[i + 1], values[i + 2]);
    }
    check_environment_texels(image, file);
    return image;
}

std::string encode_environment_exr(const EnvironmentImage& image) {
    ExrLayer layer{"", "RGB", {}};
    for (const Vec3<float>& texel : image.texels) {
        layer.values.insert(layer.values.end(), {texel.x, texel.y, texel.z});
    }
    return encode_exr({layer}, image.width, image.height);
}

EnvironmentImage read_environment_image(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::string ending = ending_of(path);
    if (ending == ".hdr") {
        return parse_hdr(read_file(file, largest_environment_file), file);
    }
    if (ending == ".exr") {
        return parse_exr(read_file(file, largest_environment_file), file);
    }
    throw InputError(file, "file name", fmt::format("the ending \"{}\"", ending), ".hdr or .exr");
}

}  // namespace pt
