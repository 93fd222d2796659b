// Measures rates of ray batches through OptiX alone, for comparison with `ptbench rays`: built-in triangles, a
// compacted tree with fast tracing preferred, one ray per thread. Built where OptiX's headers are found, by `cmake
// --build build --target rays_optix`; running needs a driver with OptiX.
// usage: rays_optix MESH.ply RAYS [REPETITIONS], where `ptbench rays` wrote both files. Prints JSON like optix_peer.py.
#include "tools/rays/rays_optix.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <optix_function_table_definition.h>
#include <optix_stubs.h>
#include <nlohmann/json.hpp>

#include "harness/bench/bootstrap.h"
#include "harness/failure.h"
#include "harness/rays/device_memory.h"
#include "harness/rays/ray_file.h"
#include "harness/rays/ray_meshes.h"

namespace pt::rays {
namespace {

using Json = nlohmann::ordered_json;

void require(OptixResult result, const char* what) {
    if (result != OPTIX_SUCCESS) {
        throw MachineError(fmt::format("rays_optix: {}: OptiX error {}", what, static_cast<int>(result)));
    }
}

template <class T>
CUdeviceptr pointer(const DeviceArray<T>& array) {
    return reinterpret_cast<CUdeviceptr>(array.data());
}

OptixDeviceContext make_context() {
    PT_CUDA_CHECK(cudaFree(nullptr));
    require(optixInit(), "start");
    OptixDeviceContext context = nullptr;
    const OptixDeviceContextOptions options{};
    require(optixDeviceContextCreate(nullptr, &options, &context), "make a context");
    return context;
}

// OptiX's compacted acceleration structure over a mesh's triangles.
class TriangleTree {
public:
    TriangleTree(OptixDeviceContext context, const RayMesh& mesh)
        : corners_(mesh.triangles), triangles_(corners_.size()) {
        const CUdeviceptr corners = pointer(corners_);
        const std::uint32_t flags = OPTIX_GEOMETRY_FLAG_DISABLE_ANYHIT;
        OptixBuildInput input{};
        input.type = OPTIX_BUILD_INPUT_TYPE_TRIANGLES;
        input.triangleArray.vertexBuffers = &corners;
        input.triangleArray.numVertices = static_cast<unsigned>(3 * triangles_);
        input.triangleArray.vertexFormat = OPTIX_VERTEX_FORMAT_FLOAT3;
        input.triangleArray.flags = &flags;
        input.triangleArray.numSbtRecords = 1;
        OptixAccelBuildOptions options{};
        options.buildFlags = OPTIX_BUILD_FLAG_PREFER_FAST_TRACE | OPTIX_BUILD_FLAG_ALLOW_COMPACTION;
        options.operation = OPTIX_BUILD_OPERATION_BUILD;
        OptixAccelBufferSizes sizes{};
        require(optixAccelComputeMemoryUsage(context, &options, &input, 1, &sizes), "size the tree");
        const DeviceArray<unsigned char> scratch(sizes.tempSizeInBytes), built(sizes.outputSizeInBytes);
        const DeviceArray<std::size_t> compacted_bytes(1);
        const OptixAccelEmitDesc emitted{pointer(compacted_bytes), OPTIX_PROPERTY_TYPE_COMPACTED_SIZE};
        const EventPair events;
        events.start();
        require(optixAccelBuild(context, nullptr, &options, &input, 1, pointer(scratch), sizes.tempSizeInBytes,
                                pointer(built), sizes.outputSizeInBytes, &handle_, &emitted, 1),
                "build the tree");
        build_ms_ = events.stop();
        nodes_ = DeviceArray<unsigned char>(compacted_bytes.host().front());
        require(optixAccelCompact(context, nullptr, handle_, pointer(nodes_), nodes_.size(), &handle_),
                "compact the tree");
        PT_CUDA_CHECK(cudaDeviceSynchronize());
    }

    OptixTraversableHandle handle() const { return handle_; }
    double build_ms() const { return build_ms_; }
    double bytes_a_triangle() const { return static_cast<double>(nodes_.size()) / static_cast<double>(triangles_); }

private:
    DeviceArray<Triangle<float>> corners_;
    DeviceArray<unsigned char> nodes_;
    std::size_t triangles_;
    OptixTraversableHandle handle_ = 0;
    double build_ms_ = 0;
};

std::string device_program() {
    std::ifstream file(PTBENCH_RAYS_OPTIX_DEVICE, std::ios::binary);
    std::string program{std::istreambuf_iterator<char>(file), {}};
    if (program.empty()) {
        throw MachineError("rays_optix: " PTBENCH_RAYS_OPTIX_DEVICE ": found nothing");
    }
    return program;
}

// The OptiX pipeline with its one kernel, and the shader binding table of a launch.
class Pipeline {
public:
    explicit Pipeline(OptixDeviceContext context) {
        OptixPipelineCompileOptions compiled{};
        compiled.numAttributeValues = 2;
        compiled.traversableGraphFlags = OPTIX_TRAVERSABLE_GRAPH_FLAG_ALLOW_SINGLE_GAS;
        compiled.pipelineLaunchParamsVariableName = "batch";
        compiled.usesPrimitiveTypeFlags = OPTIX_PRIMITIVE_TYPE_FLAGS_TRIANGLE;
        OptixModuleCompileOptions options{};
        options.optLevel = OPTIX_COMPILE_OPTIMIZATION_LEVEL_3;
        options.debugLevel = OPTIX_COMPILE_DEBUG_LEVEL_NONE;
        const std::string program = device_program();
        OptixModule module = nullptr;
        require(
            optixModuleCreate(context, &options, &compiled, program.data(), program.size(), nullptr, nullptr, &module),
            "compile the device's program");
        std::array<OptixProgramGroupDesc, 3> shaders{};
        shaders[0].kind = OPTIX_PROGRAM_GROUP_KIND_RAYGEN;
        shaders[0].raygen = {module, "__raygen__trace"};
        shaders[1].kind = OPTIX_PROGRAM_GROUP_KIND_MISS;
        shaders[1].miss = {module, "__miss__nothing"};
        shaders[2].kind = OPTIX_PROGRAM_GROUP_KIND_HITGROUP;
        shaders[2].hitgroup.moduleCH = module;
        shaders[2].hitgroup.entryFunctionNameCH = "__closesthit__nothing";
        std::array<OptixProgramGroup, 3> groups{};
        const OptixProgramGroupOptions plain{};
        require(optixProgramGroupCreate(context, shaders.data(), 3, &plain, nullptr, nullptr, groups.data()),
                "make shaders");
        OptixPipelineLinkOptions linked{};
        linked.maxTraceDepth = 1;
        require(optixPipelineCreate(context, &compiled, &linked, groups.data(), 3, nullptr, nullptr, &pipeline_),
                "link the pipeline");
        std::vector<Record> records(3);
        for (std::size_t i = 0; i < records.size(); ++i) {
            require(optixSbtRecordPackHeader(groups[i], &records[i]), "make the table of shaders");
        }
        records_ = DeviceArray<Record>(records);
        table_.raygenRecord = pointer(records_);
        table_.missRecordBase = pointer(records_) + sizeof(Record);
        table_.hitgroupRecordBase = pointer(records_) + 2 * sizeof(Record);
        table_.missRecordStrideInBytes = table_.hitgroupRecordStrideInBytes = sizeof(Record);
        table_.missRecordCount = table_.hitgroupRecordCount = 1;
    }

    // Traces a batch of rays; returns milliseconds between two CUDA events.
    double trace(const DeviceArray<OptixBatch>& batch, std::size_t rays) const {
        const EventPair events;
        events.start();
        require(optixLaunch(pipeline_, nullptr, pointer(batch), sizeof(OptixBatch), &table_,
                            static_cast<unsigned>(rays), 1, 1),
                "trace");
        return events.stop();
    }

private:
    struct alignas(OPTIX_SBT_RECORD_ALIGNMENT) Record {
        char header[OPTIX_SBT_RECORD_HEADER_SIZE];
    };

    OptixPipeline pipeline_ = nullptr;
    DeviceArray<Record> records_;
    OptixShaderBindingTable table_{};
};

Json measured(const Pipeline& pipeline, const TriangleTree& tree, const RaySet& set, std::uint64_t expected,
              int repetitions) {
    const DeviceArray<Ray> rays(set.rays);
    const DeviceArray<Hit> hits(set.rays.size());
    const DeviceArray<OptixBatch> batch(
        std::vector<OptixBatch>{{tree.handle(), rays.data(), hits.data(), set.any ? 1u : 0u}});
    (void)pipeline.trace(batch, set.rays.size());  // warm-up launch, not timed
    std::vector<double> ms;
    for (int i = 0; i < repetitions; ++i) {
        ms.push_back(pipeline.trace(batch, set.rays.size()));
    }
    std::uint64_t met = 0;
    for (const Hit& hit : hits.host()) {
        met += hit.primitive != no_primitive ? 1 : 0;
    }
    const double median = median_of(ms);
    return {{"class", set.name},
            {"query", set.any ? "any" : "closest"},
            {"rays", set.rays.size()},
            {"ms", ms},
            {"median_ms", median},
            {"grays_per_s", static_cast<double>(set.rays.size()) / median * 1e-6},
            {"hits", met},
            {"ptbench_hits", expected},
            {"hits_differ", met > expected ? met - expected : expected - met}};
}

Json run(const std::string& mesh_file, const std::string& ray_file, int repetitions) {
    const RayMesh mesh = mesh_without_box(mesh_file);
    OptixDeviceContext context = make_context();
    unsigned rt_cores = 0;
    require(optixDeviceContextGetProperty(context, OPTIX_DEVICE_PROPERTY_RTCORE_VERSION, &rt_cores, sizeof rt_cores),
            "ask for ray-tracing cores");
    const TriangleTree tree(context, mesh);
    const Pipeline pipeline(context);
    Json batches = Json::array();
    std::vector<std::uint64_t> hits;
    const std::vector<RaySet> sets = read_rays(ray_file, &hits);
    for (std::size_t i = 0; i < sets.size(); ++i) {
        batches.push_back(measured(pipeline, tree, sets[i], hits[i], repetitions));
    }
    return {{"mesh", mesh_file},
            {"optix", fmt::format("{}.{}.{}", OPTIX_VERSION / 10000, OPTIX_VERSION % 10000 / 100, OPTIX_VERSION % 100)},
            {"rtcore_version", rt_cores},
            {"repetitions", repetitions},
            {"statistic", "median of the launches' times between two events"},
            {"build_ms", tree.build_ms()},
            {"bytes_per_triangle", tree.bytes_a_triangle()},
            {"batches", batches}};
}

}  // namespace
}  // namespace pt::rays

int main(int argc, char** argv) {
    if (argc != 3 && argc != 4) {
        std::fputs("usage: rays_optix MESH.ply RAYS [REPETITIONS]\n", stderr);
        return 2;
    }
    try {
        const int repetitions = argc == 4 ? std::stoi(argv[3]) : 9;
        if (repetitions < 1) {
            throw pt::InputError("rays_optix: REPETITIONS: found " + std::string(argv[3]) + ", allowed: 1 or more");
        }
        std::puts(pt::rays::run(argv[1], argv[2], repetitions).dump(1).c_str());
        return 0;
    } catch (const pt::MachineError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
