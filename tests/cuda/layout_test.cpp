// The layouts on the device as the host sees them: how large a store is, where its fields lie, and what is written. The
// same code runs here and in the kernels.
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "variants/layout/aos.cuh"
#include "variants/layout/packed.cuh"
#include "variants/layout/soa.cuh"
#include "variants/registry.h"

namespace pt {
namespace {

// A block of memory aligned as the device's is, as far as the layouts ask for it.
struct alignas(16) Block {
    std::uint64_t words[2];
};

// Numbers that no other scalar of any path has.
void fill(std::uint32_t& word, std::uint32_t& next) { word = next++; }
void fill(SurfaceId& surface, std::uint32_t& next) { surface.code = next++; }
void fill(float& real, std::uint32_t& next) { real = static_cast<float>(next++); }
void fill(double& real, std::uint32_t& next) { real = static_cast<double>(next++); }
template <class Real>
void fill(Vec3<Real>& vector, std::uint32_t& next) {
    for (int axis = 0; axis < 3; ++axis) {
        fill(vector[axis], next);
    }
}

// Thrust and CUB read these two fields of a path whatever the layout: they lie in the store, and apart.
TEST(LayoutTest, FieldsThatOthersReadLieInTheStore) {
    for (const Choice* choice : Registry::instance().choices("layout", Backend::cuda)) {
        const cuda::Layout& layout = choice->hook.cuda.layout;
        for (const std::size_t real_bytes : {sizeof(float), sizeof(double)}) {
            for (const std::uint32_t capacity : {1u, 31u, 640000u}) {
                SCOPED_TRACE(fmt::format("{} of {} bytes, {} slots", choice->descriptor.name, real_bytes, capacity));
                const std::size_t bytes = layout.bytes(capacity, real_bytes, {});
                EXPECT_GE(bytes, capacity * (6 * real_bytes + 8));  // a ray, a pixel and a segment at the least
                EXPECT_LE(bytes, capacity * std::size_t{256} + 65536);
                // Never read here: only addresses are compared.
                std::vector<unsigned char> memory(bytes);
                const cuda::PathStore store{memory.data(), capacity};
                const cuda::FieldView segment = layout.segment(store, real_bytes);
                const cuda::FieldView origin_surface = layout.origin_surface(store, real_bytes);
                for (const cuda::FieldView& field : {segment, origin_surface}) {
                    EXPECT_GE(field.base, memory.data());
                    EXPECT_LE(field.base + std::size_t{capacity - 1} * field.stride + 4, memory.data() + bytes);
                    EXPECT_GE(field.stride, 4u);
                    EXPECT_EQ(field.stride % 4, 0u);
                    EXPECT_EQ((field.base - memory.data()) % 4, 0);
                }
                EXPECT_NE(segment.base, origin_surface.base);
            }
        }
    }
}

// Thrust and CUB may move a path and read two of its fields: in every layout and precision all fields come back as they
// were put in, and no two slots and no two fields share a place.
template <template <class> class Paths, class Real>
void expect_paths_come_back(std::uint32_t capacity) {
    std::vector<Block> memory(Paths<Real>::bytes(capacity, every_path_field) / sizeof(Block) + 1);
    const Paths<Real> paths(cuda::PathStore{reinterpret_cast<unsigned char*>(memory.data()), capacity});
    const auto path_of = [](std::uint32_t slot) {
        Path<Real> path{};
        std::uint32_t next = slot * 32;
#define PT_FILL(name, type, ...) fill(path.name, next);
        PT_PATH_FIELDS(PT_FILL, PT_FILL)
#undef PT_FILL
        return path;
    };
    for (std::uint32_t slot = 0; slot < capacity; ++slot) {
        paths.store(slot, path_of(slot));
    }
    for (std::uint32_t slot = 0; slot < capacity; ++slot) {
        const Path<Real> loaded = paths.load(slot), expected = path_of(slot);
        std::size_t equal = 0;
#define PT_EQUAL(name, ...) equal += std::memcmp(&loaded.name, &expected.name, sizeof loaded.name) == 0 ? 1u : 0u;
        PT_PATH_FIELDS(PT_EQUAL, PT_EQUAL)
#undef PT_EQUAL
        ASSERT_EQ(equal, path_field_count) << "slot " << slot;
        EXPECT_EQ(cuda::value_at(paths.segment(), slot), expected.segment);
        EXPECT_EQ(cuda::value_at(paths.origin_surface(), slot), expected.origin_surface.code);
    }
}

TEST(LayoutTest, EveryFieldComesBack) {
    for (const std::uint32_t capacity : {1u, 2u, 65u}) {
        expect_paths_come_back<layout::aos::DevicePaths, float>(capacity);
        expect_paths_come_back<layout::aos::DevicePaths, double>(capacity);
        expect_paths_come_back<layout::soa::DevicePaths, float>(capacity);
        expect_paths_come_back<layout::soa::DevicePaths, double>(capacity);
        expect_paths_come_back<layout::packed::DevicePaths, float>(capacity);
    }
}

// A stage writes what its kernels carry and, after a bounce, what a bounce changes; nothing else.
TEST(LayoutTest, ABounceWritesWhatItChanges) {
    constexpr PathFields carried = PathFields::of(set_of(Feature::motion));
    constexpr std::uint32_t capacity = 64;
    using Paths = layout::soa::DevicePaths<float>;
    std::vector<Block> memory(Paths::bytes(capacity, every_path_field) / sizeof(Block));
    const Paths paths(cuda::PathStore{reinterpret_cast<unsigned char*>(memory.data()), capacity});
    Path<float> path{};
    path.origin.x = path.radiance.x = path.time = path.bsdf_pdf = 1;
    path.pixel = path.segment = path.medium = 1;
    paths.update<carried>(3, path);
    Path<float> found = paths.load(3);
    EXPECT_EQ(found.origin.x, 1);
    EXPECT_EQ(found.segment, 1u);
    EXPECT_EQ(found.pixel, 0u);
    EXPECT_EQ(found.time, 0);
    paths.put<carried>(3, path);
    found = paths.load(3);
    EXPECT_EQ(found.pixel, 1u);
    EXPECT_EQ(found.time, 1);
    EXPECT_EQ(found.radiance.x, 0);
    EXPECT_EQ(found.bsdf_pdf, 0);
    EXPECT_EQ(found.medium, 0u);
}

// What a scene has no use for takes no memory, but in the whole record of cis565.
TEST(LayoutTest, AStoreHasRoomForTheFieldsThatAreCarried) {
    const auto bytes_of = [](const char* layout, const PathFields& fields) {
        return Registry::instance()
            .find("layout", layout, Backend::cuda)
            ->hook.cuda.layout.bytes(64, sizeof(float), fields);
    };
    constexpr PathFields all{},
        none{.radiance = false, .time = false, .medium = false, .bsdf_pdf = false, .primitive = false};
    constexpr PathFields radiance{
        .radiance = true, .time = false, .medium = false, .bsdf_pdf = false, .primitive = false};
    constexpr PathFields time{.radiance = false, .time = true, .medium = false, .bsdf_pdf = false, .primitive = false};
    constexpr PathFields medium{
        .radiance = false, .time = false, .medium = true, .bsdf_pdf = false, .primitive = false};
    constexpr PathFields density{
        .radiance = true, .time = false, .medium = false, .bsdf_pdf = true, .primitive = false};
    EXPECT_EQ(bytes_of("soa", all), 64u * 80);
    EXPECT_EQ(bytes_of("soa", density), 64u * 76);
    EXPECT_EQ(bytes_of("soa", none), 64u * 52);
    EXPECT_EQ(bytes_of("soa", radiance), 64u * 64);
    EXPECT_EQ(bytes_of("soa", time), 64u * 68);
    EXPECT_EQ(bytes_of("soa", medium), 64u * 72);
    EXPECT_EQ(bytes_of("packed", all), 64u * 80 + 8);
    EXPECT_EQ(bytes_of("packed", density), 64u * 76 + 8);
    EXPECT_EQ(bytes_of("packed", radiance), 64u * 72 + 8);
    EXPECT_EQ(bytes_of("packed", none), 64u * 56 + 8);
    EXPECT_EQ(bytes_of("packed", time), 64u * 56 + 8);  // beside the origin
    EXPECT_EQ(bytes_of("packed", medium), 64u * 72 + 8);
    EXPECT_EQ(bytes_of("aos", all), bytes_of("aos", none));
    EXPECT_EQ(bytes_of("aos", all), 64u * 80);
}

}  // namespace
}  // namespace pt
