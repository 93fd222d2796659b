// A queue in device memory made by hand, for tests of what compactions and sorts do to it. Compiled by nvcc.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "tests/gpu/choices.h"
#include "tests/support/statistics.h"
#include "variants/layout/payload_iterator.cuh"

namespace pt::test {

// Every scalar of a path. There is no padding to skip.
static_assert(sizeof(Path<float>) == 20 * sizeof(std::uint32_t));
inline bool same_bits(const Path<float>& a, const Path<float>& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Why no test can run on a GPU here; empty: one can.
inline std::string no_device() {
    int devices = 0;
    const cudaError_t error = cudaGetDeviceCount(&devices);
    if (error != cudaSuccess) {
        return std::string("no CUDA device: ") + cudaGetErrorString(error);
    }
    return devices == 0 ? "no CUDA device" : "";
}

class Stream {
public:
    // Waits for no other stream, so that work which went to another one is missed.
    Stream() { PT_CUDA_CHECK(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
    ~Stream() { (void)cudaStreamDestroy(stream_); }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    operator cudaStream_t() const { return stream_; }  // NOLINT: stands for the stream

private:
    cudaStream_t stream_ = nullptr;
};

template <class T>
std::vector<T> download(const T* device, std::size_t count) {
    std::vector<T> host(count);
    PT_CUDA_CHECK(cudaMemcpy(host.data(), device, count * sizeof(T), cudaMemcpyDeviceToHost));
    return host;
}

template <class T>
void upload(T* device, const std::vector<T>& host) {
    PT_CUDA_CHECK(cudaMemcpy(device, host.data(), host.size() * sizeof(T), cudaMemcpyHostToDevice));
    PT_CUDA_CHECK(cudaDeviceSynchronize());
}

template <class Paths>
__global__ void store_paths(cuda::PathStore store, const Path<float>* paths, std::uint32_t count) {
    const std::uint32_t slot = blockIdx.x * blockDim.x + threadIdx.x;
    if (slot < count) {
        Paths(store).store(slot, paths[slot]);
    }
}

template <class Paths>
__global__ void load_paths(cuda::PathStore store, Path<float>* paths, std::uint32_t count) {
    const std::uint32_t slot = blockIdx.x * blockDim.x + threadIdx.x;
    if (slot < count) {
        paths[slot] = Paths(store).load(slot);
    }
}

template <class Paths>
cuda::Layout layout_of() {
    return {
        [](std::uint32_t capacity, std::size_t, const PathFields& fields) { return Paths::bytes(capacity, fields); },
        [](const cuda::PathStore& store, std::size_t) { return Paths(store).segment(); },
        [](const cuda::PathStore& store, std::size_t) { return Paths(store).origin_surface(); }};
}

// What a choice is told of its cell. Tunables that are not given are at the descriptor's standard.
struct Cell {
    using Tuning = std::map<std::string, std::uint32_t, std::less<>>;

    Stream stream;
    cuda::Layout layout;
    std::uint64_t launches = 0, host_waits = 0;
    cuda::CellContext context;

    Cell(std::string_view layout_name, const Descriptor& descriptor, const Tuning& tuning) {
        cuda::visit_layout(layout_name, [&](auto paths) { layout = layout_of<typename decltype(paths)::type>(); });
        int multiprocessors = 0;
        PT_CUDA_CHECK(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, 0));
        context.layout = &layout;
        context.layout_name = layout_name;
        context.multiprocessors = static_cast<std::uint32_t>(multiprocessors);
        context.stream = stream;
        context.launches = &launches;
        context.host_waits = &host_waits;
        const std::span<const Tunable> tunables = descriptor.tunables;
        context.tunable = [tunables, tuning](std::string_view name) {
            const auto tuned = tuning.find(name);
            const auto known = std::find_if(tunables.begin(), tunables.end(),
                                            [&](const Tunable& tunable) { return tunable.name == name; });
            if (known == tunables.end()) {
                throw std::logic_error("no tunable " + std::string(name));
            }
            return tuned == tuning.end() ? known->default_value : tuned->second;
        };
    }
    Cell(const Cell&) = delete;
    Cell& operator=(const Cell&) = delete;
};

struct Shape {
    std::uint32_t count = 0;  // paths in play
    std::uint32_t slack = 0;  // by how much the bound is larger; live paths that are not in play lie there
    double ended = 0;         // fraction
    bool indirect = false;
    std::uint64_t seed = 1;
    bool with_density = true;  // else it is 0, as without next-event estimation
};

// Paths are told apart by `pixel`, which is the slot that they were put in; each has a hit that says whose it is.
class DeviceQueue {
public:
    static constexpr std::uint32_t objects = 64;

    cuda::Queue queue;
    std::vector<Path<float>> paths;    // as put in, by slot
    std::vector<std::uint32_t> order;  // as put in, by position: the identity unless indirect
    std::vector<unsigned char> object_class;

    // `stages` are the compactions and sorts under test: they get their memory from the queue's arena.
    template <class... Stages>
    DeviceQueue(Cell& cell, const Shape& shape, Stages&... stages)
        : cell_(cell), arena_(measured_bytes(shape, stages...)) {
        take(arena_, shape);
        (stages.reserve(arena_, queue), ...);
        queue.bound = shape.count + shape.slack;
        queue.indirect = shape.indirect;
        fill(shape);
    }

    // Slots that may hold a path in play: 0 to slots() - 1.
    std::uint32_t slots() const { return static_cast<std::uint32_t>(paths.size()); }
    void wait() const { PT_CUDA_CHECK(cudaStreamSynchronize(cell_.stream)); }
    std::uint32_t device_count() const {
        wait();
        return download(queue.count, 1)[0];
    }
    std::vector<std::uint32_t> device_order(std::uint32_t count) const {
        wait();
        return download(queue.order, count);
    }
    std::vector<StoredHit<float>> device_hits() const {
        wait();
        return download(static_cast<const StoredHit<float>*>(queue.hits), slots());
    }
    std::vector<Path<float>> device_paths() const {
        wait();
        std::vector<Path<float>> all(slots());
        if (all.empty()) {
            return all;
        }
        cuda::visit_layout(cell_.context.layout_name, [&](auto layout) {
            load_paths<typename decltype(layout)::type><<<blocks(), threads>>>(queue.paths, staging_, slots());
        });
        PT_CUDA_CHECK(cudaGetLastError());
        return download(staging_, slots());
    }
    // The paths in play, in their order.
    std::vector<Path<float>> in_play() const {
        const std::vector<Path<float>> all = device_paths();
        const std::uint32_t count = device_count();
        const std::vector<std::uint32_t> listed = device_order(queue.indirect ? count : 0);
        std::vector<Path<float>> found;
        for (std::uint32_t i = 0; i < count; ++i) {
            found.push_back(all.at(queue.indirect ? listed[i] : i));
        }
        return found;
    }
    void put_paths(const std::vector<Path<float>>& host) {
        if (host.empty()) {
            return;
        }
        upload(staging_, host);
        cuda::visit_layout(cell_.context.layout_name, [&](auto layout) {
            store_paths<typename decltype(layout)::type><<<blocks(), threads>>>(queue.paths, staging_, slots());
        });
        PT_CUDA_CHECK(cudaGetLastError());
        PT_CUDA_CHECK(cudaDeviceSynchronize());
    }

private:
    static constexpr std::uint32_t threads = 256;
    std::uint32_t blocks() const { return (slots() - 1) / threads + 1; }

    void fill(const Shape& shape) {
        Random random(shape.seed);
        for (std::uint32_t i = 0; i < objects; ++i) {
            object_class.push_back(static_cast<unsigned char>(random.word() & 1u));
        }
        for (std::uint32_t slot = 0; slot < queue.bound; ++slot) {
            paths.push_back(
                random_path(random, slot, slot < shape.count && random.uniform() < shape.ended, shape.with_density));
        }
        order.resize(queue.bound);
        std::iota(order.begin(), order.end(), 0u);
        std::vector<std::uint32_t> uploaded = order;
        for (std::uint32_t i = 1; i < shape.count; ++i) {  // Fisher-Yates
            std::swap(uploaded[i], uploaded[random.word() % (i + 1)]);
        }
        if (shape.indirect) {
            order = uploaded;
        }
        std::vector<StoredHit<float>> hits;
        for (std::uint32_t slot = 0; slot < queue.bound; ++slot) {
            hits.push_back({static_cast<float>(slot), SurfaceId{slot}});
        }
        upload(static_cast<StoredHit<float>*>(queue.hits), hits);
        upload(queue.order, uploaded);  // also where it is not valid: nothing may read it then
        upload(queue.count, {shape.count});
        upload(queue.count_spare, {0x7fffffffu});
        upload(classes_, object_class);
        put_paths(paths);
    }

    // Everything that is in the arena, measured or taken.
    void take(cuda::Arena& arena, const Shape& shape) {
        const std::uint32_t capacity = shape.count + shape.slack + 5;
        const std::size_t store_bytes = cell_.layout.bytes(capacity, sizeof(float), {});
        queue.capacity = capacity;
        queue.paths = {arena.take_bytes(store_bytes), capacity};
        queue.spare = {arena.take_bytes(store_bytes), capacity};
        queue.hits = arena.take<StoredHit<float>>(capacity);
        queue.order = arena.take<std::uint32_t>(capacity);
        queue.order_spare = arena.take<std::uint32_t>(capacity);
        queue.keys = arena.take<std::uint32_t>(capacity);
        queue.keys_spare = arena.take<std::uint32_t>(capacity);
        queue.count = arena.take<std::uint32_t>(1);
        queue.count_spare = arena.take<std::uint32_t>(1);
        classes_ = arena.take<unsigned char>(objects);
        staging_ = arena.take<Path<float>>(capacity);
        queue.object_class = classes_;
    }
    template <class... Stages>
    std::size_t measured_bytes(const Shape& shape, Stages&... stages) {
        cuda::Arena measuring;
        take(measuring, shape);
        (stages.reserve(measuring, queue), ...);
        return measuring.used();
    }
    static Path<float> random_path(Random& random, std::uint32_t id, bool ended, bool with_density) {
        Path<float> path{};
        std::uint32_t words[sizeof path / sizeof(std::uint32_t)];
        for (std::uint32_t& word : words) {
            word = random.word() & 0xff7fffffu;  // as a number: finite, so that a copy keeps its bits
        }
        std::memcpy(&path, words, sizeof path);
        path.pixel = id;
        path.bsdf_pdf = with_density ? path.bsdf_pdf : 0.0f;
        path.primitive = with_density ? path.primitive : 0u;
        path.segment = ended ? Path<float>::ended : id % 7;
        path.origin_surface =
            id % 8 == 0 ? SurfaceId{} : SurfaceId::of(path.origin_surface.code % objects, id % 2 == 0);
        return path;
    }

    Cell& cell_;
    unsigned char* classes_ = nullptr;
    Path<float>* staging_ = nullptr;
    cuda::Arena arena_;
};

}  // namespace pt::test
