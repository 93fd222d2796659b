#include "harness/cuda/cell.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <mutex>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kernels/scene_arrays.h"
#include "variants/cuda/device.h"

namespace pt::cuda {

namespace {

const Hooks& hooks(std::string_view axis, const Variant& variant) {
    return Registry::instance().at(axis, variant, Backend::cuda).hook.cuda;
}

// Modules stay loaded: a variant's kernels are compiled, or read from the cache on disk, once a process.
struct LoadedModules {
    std::map<std::string, std::unique_ptr<Module>> by_request;
    static LoadedModules& instance() {
        static LoadedModules modules;
        return modules;
    }
};

std::string request_text(const ModuleRequest& request) {
    return fmt::format("{}|{}|{}|{}|{}|{}|{}|{}|{}", request.prelude, request.name, request.features, request.real,
                       request.layout, request.sort_key, request.architecture, fmt::join(request.options, " "),
                       fmt::join(request.defines, " "));
}

template <class T>
View<T> placed(Arena& arena, const View<T>& host) {
    return {arena.take<T>(host.size), host.size};
}

template <class T>
void copy_to_device(const View<T>& device, const View<T>& host, cudaStream_t stream) {
    if (host.size != 0) {
        PT_CUDA_CHECK(cudaMemcpyAsync(const_cast<T*>(device.data), host.data, host.size * sizeof(T),
                                      cudaMemcpyHostToDevice, stream));
    }
}

double process_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

// A box round all objects, relative to the eye: each within its half diagonal of its centre.
KeyBounds key_bounds(const Scene& scene) {
    Vec3d low(1e300), high(-1e300);
    for (const SceneObject& object : scene.objects) {
        const Vec3d centre = object.translate - scene.camera.eye;
        const double reach = 0.5 * std::sqrt(dot(object.scale, object.scale));
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], centre[axis] - reach);
            high[axis] = std::max(high[axis], centre[axis] + reach);
        }
    }
    KeyBounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = high[axis] - low[axis];
        bounds.low[axis] = static_cast<float>(low[axis]);
        bounds.inverse_extent[axis] = extent > 0 ? static_cast<float>(1 / extent) : 0.0f;
    }
    return bounds;
}

bool has_tunable(const Variant& variant, std::string_view name) {
    for (const Tunable& tunable : tunables_of(variant, Backend::cuda)) {
        if (tunable.name == name) {
            return true;
        }
    }
    return false;
}

std::uint32_t tuned(const Variant& variant, std::string_view name, std::uint32_t otherwise) {
    return has_tunable(variant, name) ? tunable(variant, name, Backend::cuda) : otherwise;
}

ModuleRequest request_for(const Variant& variant, const std::string& source, const std::string& architecture) {
    ModuleRequest request;
    request.name = source;
    request.includes = {source};
    request.real = hooks("precision", variant).real;
    request.layout = variant["layout"];
    request.sort_key = variant["sort_key"];
    request.architecture = architecture;
    return request;
}

}  // namespace

std::string integrator_source(const Variant& variant) {
    const char* const own = hooks("integrator", variant).integrator.source;
    return own != nullptr ? own : "variants/integrator/" + variant["integrator"] + ".cuh";
}

namespace {

template <class Real>
std::vector<unsigned char> constant_scene(const SceneView<Real>& scene, FeatureSet features) {
    std::vector<unsigned char> bytes;
    for_each_array(scene, [&](const SceneArray& array, const auto& view) {
        if (!array.is_traced(features)) {
            return;
        }
        const auto* const begin = reinterpret_cast<const unsigned char*>(view.data);
        bytes.insert(bytes.end(), begin, begin + view.size * sizeof(*view.data));
        bytes.resize((bytes.size() + 15) / 16 * 16);
    });
    return bytes;
}

// Of the 64 KiB of constant memory that a module may have; larger scenes stay in global memory.
constexpr std::size_t constant_bytes = 32768;

// The scene's numbers of objects and which of them are a room's walls, as constants where the kernel has the scene's
// features only.
template <class Real>
std::vector<std::string> scene_defines(const SceneView<Real>& scene, FeatureSet features) {
    // A kernel with everything is compiled once, for any scene.
    const bool fixes_counts = (features & all_features) != all_features;
    const bool fits = constant_scene(scene, features).size() <= constant_bytes;
    std::vector<std::string> defines{fmt::format("-DPT_SCENE_BYTES={}", fits ? constant_bytes : 0),
                                     fmt::format("-DPT_FIXED_COUNTS={}", fixes_counts ? 1 : 0)};
    if (fixes_counts) {
#define PT_DEFINE(name, kind, word) defines.push_back(fmt::format("-DPT_" #word "={}u", scene.name.size));
        PT_OBJECT_ARRAYS(PT_DEFINE)
#undef PT_DEFINE
        const AxisAlignedEnclosure<Real>& enclosure = scene.enclosure;
        defines.push_back(fmt::format("-DPT_ENCLOSURE_WALLS={}u", enclosure.walls));
        defines.push_back(fmt::format("-DPT_ENCLOSURE_LAMPS={}u", enclosure.lamps));
        defines.push_back(fmt::format("-DPT_ENCLOSURE_OPEN_SIDES={}u", enclosure.open_sides));
        const auto codes = [](const SurfaceId(&sides)[3]) {
            return fmt::format("{}u,{}u,{}u", sides[0].code, sides[1].code, sides[2].code);
        };
        defines.push_back("-DPT_ENCLOSURE_LOW_SIDES=" + codes(enclosure.low_side));
        defines.push_back("-DPT_ENCLOSURE_HIGH_SIDES=" + codes(enclosure.high_side));
    }
    return defines;
}

// Arrays of words under which device.cuh finds the scene's numbers: constants that the compiler sees through.
class BakedText {
public:
    template <class T>
    void add(const char* name, const T* values, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
        std::vector<std::uint32_t> words(std::max<std::size_t>(1, count * sizeof(T) / 4));
        if (count != 0) {
            std::memcpy(words.data(), static_cast<const void*>(values), count * sizeof(T));
        }
        text_ +=
            fmt::format("__device__ alignas(16) const unsigned {}[] = {{{:#x}u}};\n", name, fmt::join(words, "u,"));
    }
    template <class T>
    void add(const char* name, const View<T>& view) {
        add(name, view.data, view.size);
    }
    void add_count(const char* name, std::uint32_t count) {
        text_ += fmt::format("constexpr unsigned {} = {}u;\n", name, count);
    }
    std::string text() const { return "#define PT_BAKED 1\nnamespace baked { namespace {\n" + text_ + "} }\n"; }

private:
    std::string text_;
};

template <class Real>
std::string baked_text(const SceneView<Real>& scene) {
    BakedText text;
    for_each_array(scene, [&](const SceneArray& array, const auto& view) {
        if (array.kind != ArrayKind::matrix) {
            text.add(array.name, view);
        }
    });
    text.add("environment", &scene.environment, 1);
    text.add("enclosure", &scene.enclosure, 1);
    Camera<Real> camera = scene.camera;  // what a render sets is no part of the text, nor of the cache's key
    camera.width = camera.height = 0;
    camera.pixel_size = 0;
    text.add("camera", &camera, 1);
#define PT_ADD_COUNT(name, kind, word) text.add_count(#word "_count", scene.name.size);
    PT_SHARED_ARRAYS(PT_ADD_COUNT)
#undef PT_ADD_COUNT
    return text.text();
}

template <class Real>
void describe_scene(const Scene& scene, bool bakes, ModuleRequest& request) {
    const SceneBuffers<Real> buffers(scene, default_settings(scene));
    for (std::string& define : scene_defines(buffers.view(), request.features)) {
        request.defines.push_back(std::move(define));
    }
    if (bakes) {
        request.prelude = baked_text(buffers.view());
    }
}

}  // namespace

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture) {
    const FeatureSet features = choose_kernel(scene, variant, Backend::cuda).compiled;
    ModuleRequest request = request_for(variant, integrator_source(variant), architecture);
    const Integrator& integrator = hooks("integrator", variant).integrator;
    request.features = features;
    request.options = hooks("arithmetic", variant).options;
    const std::uint32_t kept =
        Registry::instance().at("first_bounce", variant, Backend::cuda).hook.first_bounce(variant, Backend::cuda);
    request.defines = {
        fmt::format("-DPT_BLOCK={}", tunable(variant, "block", Backend::cuda)),
        fmt::format("-DPT_MIN_BLOCKS={}", tuned(variant, "min_blocks", 0) / (variant["precision"] == "double" ? 2 : 1)),
        fmt::format("-DPT_CACHED={}", kept > 0 ? 1 : 0),
        fmt::format("-DPT_SHADING_FMAS={}", tuned(variant, "shading_fmas", 0))};
    const bool bakes = hooks("specialisation", variant).bakes_scene;
    if (request.real == "double") {
        describe_scene<double>(scene, bakes, request);
    } else {
        describe_scene<float>(scene, bakes, request);
    }
    if (integrator.defines != nullptr) {
        const std::vector<std::string> more = integrator.defines(variant);
        request.defines.insert(request.defines.end(), more.begin(), more.end());
    }
    if (!integrator.has_queue) {
        request.layout = "aos";  // not used: one compilation serves
    }
    if (!integrator.stores_hits) {
        request.sort_key = "material";
    }
    return request;
}

// Stages move paths and count them; they do no arithmetic on them, so neither features nor arithmetic matter.
ModuleRequest stage_request(const Variant& variant, const std::string& source, const std::string& architecture) {
    ModuleRequest request = request_for(variant, source, architecture);
    request.features = no_features;
    request.sort_key = "material";
    request.defines = {"-DPT_BLOCK=256",      "-DPT_MIN_BLOCKS=0",  "-DPT_CACHED=0",
                       "-DPT_SHADING_FMAS=0", "-DPT_SCENE_BYTES=0", "-DPT_FIXED_COUNTS=0"};
    return request;
}

template <class Real>
const Module& RenderCell<Real>::module(const ModuleRequest& request) {
    std::unique_ptr<Module>& module = LoadedModules::instance().by_request[request_text(request)];
    if (module == nullptr) {
        const ModuleImage image = build_module(request);
        module = std::make_unique<Module>(image);
        facts_.compile_seconds += image.compile_seconds;
        facts_.from_cache = facts_.from_cache && image.from_cache;
    }
    return *module;
}

template <class Real>
CellContext RenderCell<Real>::context() {
    CellContext context;
    context.layout = &layout_;
    context.layout_name = request_.variant["layout"];
    context.real_bytes = sizeof(Real);
    context.materials = job_.materials;
    context.multiprocessors = job_.multiprocessors;
    context.stream = job_.stream;
    context.tunable = [this](std::string_view name) { return tunable(request_.variant, name, Backend::cuda); };
    context.module = [this](const std::string& source) -> const Module& {
        return module(stage_request(request_.variant, source, device().architecture()));
    };
    context.launches = &choice_launches_;
    context.host_waits = &choice_waits_;
    return context;
}

template <class Real>
RenderCell<Real>::RenderCell(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                             const KernelChoice& kernel, const FilmView& film)
    : scene_(scene),
      request_(request),
      kernel_(kernel),
      buffers_(scene, settings),
      host_film_(film),
      layout_(hooks("layout", request.variant).layout) {
    const Variant& variant = request.variant;
    facts_.from_cache = true;
    const Integrator& integrator = hooks("integrator", variant).integrator;
    job_.module = &module(module_request(scene, variant, device().architecture()));
    const auto start = std::chrono::steady_clock::now();
    PT_CUDA_CHECK(cudaStreamCreateWithFlags(&job_.stream, cudaStreamNonBlocking));
    PT_CUDA_CHECK(cudaEventCreate(&begin_));
    PT_CUDA_CHECK(cudaEventCreate(&end_));
    PT_CUDA_CHECK(cudaMallocHost(reinterpret_cast<void**>(&job_.pinned_count), 64 * sizeof(std::uint32_t)));
    job_.pixels = settings.width * settings.height;
    job_.longest_path = buffers_.view().longest_path();
    job_.materials = buffers_.view().materials.size;
    job_.first_sample = request.first_sample;
    job_.samples = request.samples;
    job_.samples_in_flight = std::min(tuned(variant, "spp_in_flight", 1), request.samples);
    job_.block = tunable(variant, "block", Backend::cuda);
    job_.samples_per_piece = tuned(variant, "piece", 1);
    job_.append_counters = tuned(variant, "append_counters", 1);
    job_.reads_back = tuned(variant, "read_back", 0) != 0;
    job_.multiprocessors = static_cast<std::uint32_t>(device().multiprocessors);
    job_.cache.rays =
        Registry::instance().at("first_bounce", variant, Backend::cuda).hook.first_bounce(variant, Backend::cuda);
    job_.sort_key = hooks("sort_key", variant).sort_key;
    job_.key_bounds = key_bounds(scene);
    job_.is_captured = hooks("launch", variant).is_captured;
    job_.loops = hooks("launch", variant).loops;
    job_.stages = request.instrument ? &stages_ : nullptr;
    job_.appends_in_kernel = integrator.appends_in_kernel != nullptr && integrator.appends_in_kernel(variant);
    if (integrator.has_queue && hooks("compaction", variant).compaction != nullptr) {
        compaction_ = hooks("compaction", variant).compaction(context());
    }
    if (integrator.has_queue && hooks("sorting", variant).sorting != nullptr) {
        sorting_ = hooks("sorting", variant).sorting(context());
    }
    job_.compaction = compaction_.get();
    job_.sorting = sorting_.get();

    Arena measuring;
    reserve(measuring);
    arena_ = std::make_unique<Arena>(measuring.used());
    reserve(*arena_);
    upload();
    facts_.device_bytes = measuring.used();
    facts_.threads = job_.block;
    facts_.options = job_.module->image().options;
    if (integrator.prepare != nullptr) {
        integrator.prepare(job_);
        choice_launches_ = 0;  // what was captured has not been launched
    }
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    facts_.prepare_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

template <class Real>
RenderCell<Real>::~RenderCell() {
    // Work that is still in flight after a failure must not outlive its memory.
    if (job_.stream != nullptr) {
        (void)cudaStreamSynchronize(job_.stream);
    }
    job_.graph.reset();
    if (begin_ != nullptr) {
        (void)cudaEventDestroy(begin_);
    }
    if (end_ != nullptr) {
        (void)cudaEventDestroy(end_);
    }
    if (job_.pinned_count != nullptr) {
        (void)cudaFreeHost(job_.pinned_count);
    }
    if (job_.stream != nullptr) {
        (void)cudaStreamDestroy(job_.stream);
    }
}

template <class Real>
void RenderCell<Real>::reserve(Arena& arena) {
    const SceneView<Real>& host = buffers_.view();
    view_ = host;
    for_each_array(view_, host, [&](const SceneArray& array, auto& device, const auto& values) {
        if (array.is_used(kernel_.compiled)) {
            device = placed(arena, values);
        }
    });
    job_.scene = {&view_};
    job_.film = host_film_;
    job_.film.sums = arena.take<std::int64_t>(std::size_t{3} * job_.pixels);
    job_.film.faults = arena.take<FilmFaults>(1);
    job_.totals = arena.take<Totals>(counter_copies);
    job_.health = health_request(scene_, buffers_.file_index());
    job_.health.counters = arena.take<HealthCounters>(1);
    job_.next_item = arena.take<std::uint64_t>(1);
    job_.next_sample = arena.take<std::uint32_t>(1);
    job_.loop.offset = arena.take<std::uint32_t>(1);
    job_.loop.rounds = arena.take<std::uint64_t>(1);
    job_.segments.copies = job_.longest_path <= few_segments ? counter_copies : 1;
    const std::size_t segment_counts = std::size_t{job_.longest_path} * job_.segments.copies;
    job_.segments.live = arena.take<std::uint64_t>(segment_counts);
    job_.lengths = request_.instrument ? job_.segments.live : nullptr;
    job_.segments.in_play = arena.take<std::uint64_t>(segment_counts);
    job_.cache.hits =
        reinterpret_cast<Hit<float>*>(arena.take_bytes(std::size_t{job_.pixels} * job_.cache.rays * sizeof(Hit<Real>)));
    if (hooks("integrator", request_.variant).integrator.has_queue) {
        reserve_queue(arena);
    }
}

template <class Real>
bool RenderCell<Real>::copies_whole_paths() const {
    return (compaction_ != nullptr && !job_.appends_in_kernel && compaction_->moves_paths()) ||
           (sorting_ != nullptr && sorting_->moves_paths());
}

// As path_fields in device.cuh, unless somebody copies whole paths.
template <class Real>
PathFields RenderCell<Real>::carried_fields() const {
    const bool whole = copies_whole_paths();
    const bool connects = contains(kernel_.compiled, Feature::next_event);
    return {.radiance = whole || connects || contains(kernel_.compiled, Feature::emission),
            .time = whole || contains(kernel_.compiled, Feature::motion),
            .medium = whole || contains(kernel_.compiled, Feature::absorption),
            .density = whole || connects};
}

template <class Real>
void RenderCell<Real>::reserve_queue(Arena& arena) {
    const std::size_t before = arena.used();
    Queue& queue = job_.queue;
    const std::uint64_t pool = std::uint64_t{job_.pixels} * job_.samples_in_flight;
    if (pool > 0x7fffffffu) {
        throw Error(fmt::format("{} paths in flight: spp_in_flight is too large for {} pixels", pool, job_.pixels));
    }
    queue.capacity = static_cast<std::uint32_t>(pool);
    if (job_.appends_in_kernel) {
        // Each part has room for its share of the blocks.
        const std::uint64_t blocks = (pool + job_.block - 1) / job_.block;
        const std::uint64_t blocks_per_part = (blocks + job_.append_counters - 1) / job_.append_counters;
        queue.capacity = static_cast<std::uint32_t>(blocks_per_part * job_.append_counters * job_.block);
    }
    const std::size_t store_bytes = layout_.bytes(queue.capacity, sizeof(Real), carried_fields());
    facts_.path_state_bytes = store_bytes / queue.capacity;
    const auto take_paths = [&]() -> PathStore { return {arena.take_bytes(store_bytes), queue.capacity}; };
    queue.paths = take_paths();
    const bool needs_spare = job_.appends_in_kernel || (compaction_ != nullptr && compaction_->needs_spare_paths());
    if (needs_spare) {
        queue.spare = take_paths();
    }
    if (hooks("integrator", request_.variant).integrator.stores_hits) {
        queue.hits = arena.take<Hit<Real>>(queue.capacity);
    }
    if (compaction_ != nullptr || sorting_ != nullptr) {
        queue.order = arena.take<std::uint32_t>(queue.capacity);
        queue.order_spare = arena.take<std::uint32_t>(queue.capacity);
    }
    if (sorting_ != nullptr) {
        queue.keys = arena.take<std::uint32_t>(queue.capacity);
        queue.keys_spare = arena.take<std::uint32_t>(queue.capacity);
    }
    if (job_.appends_in_kernel) {
        job_.append_counts = arena.take<std::uint32_t>(std::size_t{job_.append_counters} * 32 * job_.longest_path);
    }
    queue.count = arena.take<std::uint32_t>(1);
    queue.count_spare = arena.take<std::uint32_t>(1);
    queue.bound = queue.capacity;
    unsigned char* const classes = arena.take<unsigned char>(scene_.objects.size());
    queue.object_class = classes;
    if (compaction_ != nullptr && !job_.appends_in_kernel) {
        compaction_->reserve(arena, queue);
    }
    if (sorting_ != nullptr) {
        sorting_->reserve(arena, queue);
    }
    facts_.path_bytes = (arena.used() - before) / queue.capacity;
}

template <class Real>
void RenderCell<Real>::upload() {
    const SceneView<Real>& host = buffers_.view();
    for_each_array(view_, host, [&](const SceneArray& array, const auto& device, const auto& values) {
        if (array.is_used(kernel_.compiled)) {
            copy_to_device(device, values, job_.stream);
        }
    });
    const std::vector<unsigned char> constant = constant_scene(host, kernel_.compiled);
    const bool is_baked = hooks("specialisation", request_.variant).bakes_scene;
    if (!is_baked && !constant.empty() && constant.size() <= constant_bytes) {
        PT_CUDA_CHECK(cudaMemcpyAsync(job_.module->global("pt_scene"), constant.data(), constant.size(),
                                      cudaMemcpyHostToDevice, job_.stream));
    }
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));  // the host's copy ends with this function
    const auto clear = [&](void* memory, std::size_t bytes) {
        if (memory != nullptr && bytes != 0) {
            PT_CUDA_CHECK(cudaMemsetAsync(memory, 0, bytes, job_.stream));
        }
    };
    clear(job_.film.sums, std::size_t{3} * job_.pixels * sizeof(std::int64_t));
    clear(job_.film.faults, sizeof(FilmFaults));
    clear(job_.loop.offset, sizeof(std::uint32_t));
    clear(job_.loop.rounds, sizeof(std::uint64_t));
    clear(job_.totals, counter_copies * sizeof(Totals));
    static const HealthCounters healthy;
    PT_CUDA_CHECK(cudaMemcpyAsync(job_.health.counters, &healthy, sizeof healthy, cudaMemcpyHostToDevice, job_.stream));
    const std::size_t segment_bytes = std::size_t{job_.longest_path} * job_.segments.copies * sizeof(std::uint64_t);
    clear(job_.segments.live, segment_bytes);
    clear(job_.segments.in_play, segment_bytes);
    Queue& queue = job_.queue;
    if (queue.count == nullptr) {
        return;
    }
    // Positions beyond the count are carried along by sorts though nobody looks at what they hold.
    for (std::uint32_t* const index : {queue.order, queue.order_spare, queue.keys, queue.keys_spare}) {
        clear(index, std::size_t{queue.capacity} * sizeof(std::uint32_t));
    }
    if (copies_whole_paths()) {
        // What the scene's kernels never write is copied along.
        clear(queue.paths.base, layout_.bytes(queue.capacity, sizeof(Real), {}));
    }
    clear(queue.count, sizeof(std::uint32_t));
    clear(queue.count_spare, sizeof(std::uint32_t));
    std::vector<unsigned char> classes;
    for (std::uint32_t object = 0; object < host.object_material.size; ++object) {
        const MaterialType type = host.materials[host.object_material[object]].type;
        classes.push_back(type == MaterialType::mirror || type == MaterialType::dielectric ? 1 : 0);
    }
    PT_CUDA_CHECK(cudaMemcpyAsync(const_cast<unsigned char*>(queue.object_class), classes.data(), classes.size(),
                                  cudaMemcpyHostToDevice, job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
}

// Between two parts everything stays on the device as it is: the film, the counters, the cache, the graph. Nobody waits
// but for the end of a part.
template <class Real>
void RenderCell<Real>::run(RenderResult& result) {
    for (const RenderPart& part : parts_of(request_)) {
        run_part(part, result);
        if (is_shown(request_)) {
            download_film(result.film);
            report_checkpoint(request_, part, result);
        }
    }
}

template <class Real>
void RenderCell<Real>::run_part(const RenderPart& part, RenderResult& result) {
    const Integrator& integrator = hooks("integrator", request_.variant).integrator;
    job_.first_sample = request_.first_sample + part.done;
    job_.samples = part.samples;
    const double cpu_start = process_cpu_ms();
    const auto start = std::chrono::steady_clock::now();
    PT_CUDA_CHECK(cudaEventRecord(begin_, job_.stream));
    integrator.render(job_);
    PT_CUDA_CHECK(cudaEventRecord(end_, job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    result.wall_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    result.cpu_ms += process_cpu_ms() - cpu_start;
    float milliseconds = 0;
    PT_CUDA_CHECK(cudaEventElapsedTime(&milliseconds, begin_, end_));
    result.device_ms += milliseconds;
}

template <class Real>
void RenderCell<Real>::download_film(Film& film) {
    std::vector<std::int64_t> sums(std::size_t{3} * job_.pixels);
    FilmFaults faults;
    PT_CUDA_CHECK(cudaMemcpyAsync(sums.data(), job_.film.sums, sums.size() * sizeof(std::int64_t),
                                  cudaMemcpyDeviceToHost, job_.stream));
    PT_CUDA_CHECK(cudaMemcpyAsync(&faults, job_.film.faults, sizeof faults, cudaMemcpyDeviceToHost, job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    film.set(std::move(sums), faults);
}

namespace {

Totals sum_of(const std::vector<Totals>& copies) {
    Totals sum;
    for (const Totals& copy : copies) {
        sum.paths.paths += copy.paths.paths;
        sum.paths.rays += copy.paths.rays;
        sum.paths.connections += copy.paths.connections;
        sum.paths.unfinished_walks += copy.paths.unfinished_walks;
        sum.cache_fills += copy.cache_fills;
        sum.cache_uses += copy.cache_uses;
    }
    return sum;
}

std::vector<std::uint64_t> sum_of_copies(const std::vector<std::uint64_t>& counts, std::uint32_t copies) {
    std::vector<std::uint64_t> sums(counts.size() / copies);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        sums[i / copies] += counts[i];
    }
    return sums;
}

}  // namespace

template <class Real>
void RenderCell<Real>::collect(RenderResult& result) {
    const auto download = [&](auto* host, const auto* device, std::size_t count) {
        PT_CUDA_CHECK(cudaMemcpyAsync(host, device, count * sizeof(*host), cudaMemcpyDeviceToHost, job_.stream));
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    };
    download_film(result.film);
    std::vector<Totals> copies(counter_copies);
    download(copies.data(), job_.totals, copies.size());
    download(&result.health, job_.health.counters, 1);
    const Totals totals = sum_of(copies);
    const auto by_segment = [&](const std::uint64_t* device_counts) {
        std::vector<std::uint64_t> counts(std::size_t{job_.longest_path} * job_.segments.copies);
        download(counts.data(), device_counts, counts.size());
        return counts;
    };
    // Megakernels count path lengths in the place of `live`, without copies.
    const bool has_queue = hooks("integrator", request_.variant).integrator.has_queue;
    std::vector<std::uint64_t> live = by_segment(job_.segments.live);
    std::vector<std::uint64_t> in_play = by_segment(job_.segments.in_play);
    if (has_queue) {
        live = sum_of_copies(live, job_.segments.copies);
        in_play = sum_of_copies(in_play, job_.segments.copies);
    }
    live.resize(job_.longest_path);

    WorkCounters& work = result.work;
    work = job_.work;
    std::uint64_t rounds = 0;
    download(&rounds, job_.loop.rounds, 1);
    for (std::uint64_t round = 0; round < rounds; ++round) {
        work += job_.loop.work_per_round;
    }
    work.loop_rounds = rounds;
    work.launches += choice_launches_;
    work.host_waits += choice_waits_;
    work.paths = totals.paths.paths;
    work.connections = totals.paths.connections;
    work.unfinished_walks = totals.paths.unfinished_walks;
    work.cache_fills = totals.cache_fills;
    std::uint64_t cache_uses = totals.cache_uses;
    if (has_queue) {
        std::uint64_t segments = 0;
        for (const std::uint64_t count : live) {
            segments += count;
        }
        cache_uses = job_.cache.rays > 0 ? live.front() : 0;
        work.rays = segments - cache_uses + totals.cache_fills + totals.paths.connections;
        work.last_paths = live.back();
        work.sorted = work.sorts > 0 ? segments - live.back() : 0;
        work.compacted_away = work.compactions > 0 ? in_play.front() - in_play.back() : 0;
    } else {
        work.rays = totals.paths.rays;
        // `live` holds paths by the number of their segments here.
        std::uint64_t alive = 0;
        for (std::size_t segment = live.size(); segment-- > 0;) {
            alive += live[segment];
            live[segment] = alive;
        }
    }
    work.cache_hits = cache_uses - totals.cache_fills;
    if (request_.instrument) {
        result.stages.milliseconds = stages_.milliseconds();
        for (const std::uint64_t count : live) {
            if (count == 0) {
                break;
            }
            result.stages.live_paths.push_back(count);
        }
    }
    for (const char* name : hooks("integrator", request_.variant).integrator.kernels) {
        if (name == nullptr) {
            break;
        }
        const KernelFacts kernel = job_.module->facts(name);
        facts_.kernels.push_back({name, kernel.registers, kernel.local_bytes, kernel.shared_bytes});
    }
    result.cuda = facts_;
}

template class RenderCell<float>;
template class RenderCell<double>;

}  // namespace pt::cuda
