// The axes, and for each a struct of traits: what its choices tell the choices of other axes. A choice that depends on
// another one asks for a trait, never for a name, so a new choice works with all others by its traits alone. Defaults
// are those of the axis's usual choice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <variant>

#include "variants/cuda/append_in_kernel.h"

namespace pt {

struct Axis {
    std::string_view key;
    std::string_view what;        // in a line
    std::string_view since = "";  // the commit that brought it; empty: the first one. Older result files lack the axis.
    std::string_view as_before = "";  // what every variant was until then; empty: of the first axes
};

// The axis whose choice a variant's name begins with.
inline constexpr std::string_view integrator_axis = "integrator";

// The axes, in the order in which a variant's name spells their choices.
inline constexpr Axis axis_table[] = {
    {"integrator", "how paths are traced: as a queue, or one at a time"},
    {"compaction", "how ended paths are taken out of the queue"},
    {"sorting", "how paths are put in order before they are shaded"},
    {"sort_key", "what they are put in order by", "5fdf3ee", "material"},
    {"first_bounce", "whether first hits are kept and used again"},
    {"direct_light", "whether vertices are connected to lights"},
    {"russian_roulette", "whether paths end by chance", "7b5cd03", "off"},
    {"sampler", "where random numbers come from", "7b5cd03", "pcg4d"},
    {"layout", "how paths lie in memory"},
    {"specialisation", "what of a kernel is left out for a scene"},
    {"launch", "how kernels are launched", "5fdf3ee", "stream"},
    {"arithmetic", "how the compiler may round", "5fdf3ee", "exact"},
    {"precision", "single or double precision, and where", "5fdf3ee", "float"},
    {"robustness", "the forms that are stable, or the textbook's", "94b5403", "robust"},
    {"accelerator", "how a ray finds the triangles of a mesh", "4dc231d", "brute_force"},
    {"builder", "how the tree over a mesh is built", "4dc231d", "sah_binned"},
    {"traversal", "in which order a warp's lanes visit nodes and test triangles", "148f491", "while_while"},
    {"traversal_stack", "where nodes wait that a ray has yet to visit", "148f491", "local"},
    {"levels", "how a ray finds the objects that show meshes", "0f46c45", "each_object"},
    {"light_sampling", "how points on lights are drawn", "a7e8939", "solid_angle"},
    {"devices", "how many GPUs of the host render one image", "14df631", "1"},
    {"partition", "which of its samples or pixels each of them takes", "14df631", "samples"},
    {"light_selection", "which of several lights is drawn", "48ac371", "uniform"},
    {"subsurface_sampling", "how walks through bodies are drawn", "c229cea", "classical"},
};
inline constexpr std::size_t axis_count = std::size(axis_table);

inline constexpr std::array<std::string_view, axis_count> axis_names = [] {
    std::array<std::string_view, axis_count> names;
    for (std::size_t i = 0; i < axis_count; ++i) {
        names[i] = axis_table[i].key;
    }
    return names;
}();

// ---- What a choice says of itself, by axis ----

struct IntegratorTraits {
    bool has_queue = false;             // paths lie in memory between stages: to be compacted, sorted and laid out
    bool can_loop = false;              // on CUDA: its bounces can be the loop of a graph
    bool appends_in_kernel = false;     // does in its own kernel what a compaction with AppendInKernel does
    bool seeds_by_position = false;     // tells a sampler where in the queue a path lies
    bool sums_in_order = false;         // adds a pixel's samples in their order
    bool traces_in_own_kernel = false;  // which can be one whose warps fetch rays
    bool keeps_branches = false;        // a path may split: its branches wait beside it
    bool refills_queue = false;         // paths of any number of segments are in the queue together
    bool inspects = false;              // looks at every path's state between stages: for health, not for times
};

struct CompactionTraits {
    bool compacts = true;
    bool payload_contiguous = true;  // the paths in play are slots 0 to count - 1 afterwards
    bool host_sync = false;          // on CUDA: the host waits for the device within it, so no graph can hold it
    bool reproducible_order = true;  // a path has the same position in every run
    AppendInKernel append_in_kernel = AppendInKernel::no;

    constexpr bool can_append_in_kernel() const { return append_in_kernel != AppendInKernel::no; }
};

struct SortingTraits {
    bool sorts = true;
    bool host_sync = false;          // as of a compaction
    bool reproducible_order = true;  // as of a compaction
};

// A key is (material << bits) + rest, or rest alone; rest is below 2^bits. By chunk it is a number of its own for each
// material of each chunk of the queue's slots: the chunk comes first, then the material, and bits is 0.
struct SortKeyTraits {
    std::uint32_t bits = 0;
    bool has_material = true;  // which is known only after the hit; other keys sort paths before they are traced
    bool by_chunk = false;     // it has the tunable `chunk`

    constexpr bool is_material_alone() const { return has_material && bits == 0 && !by_chunk; }
    // Whether a counting sort can take the keys: there are as many as materials (or as many a chunk), few enough to be
    // counted.
    constexpr bool is_countable() const { return has_material && bits == 0; }
};

struct FirstBounceTraits {
    bool keeps_hits = true;
};

struct DirectLightTraits {
    bool connects = true;                // some vertex is connected to a light
    bool connects_every_vertex = false;  // a path carries its last BSDF density, for the MIS weight of light it meets
    bool counts_light_met = true;        // after a vertex that was connected
};

struct RouletteTraits {
    bool ends_paths = true;
    bool splits_paths = false;
};

struct SamplerTraits {
    bool is_in_every_kernel = false;  // it has no feature bit: every kernel contains it
    bool is_by_position = false;      // a path's numbers follow from where it lies in the queue
};

struct LayoutTraits {
    bool keeps_paths_whole = false;  // a path is stored as one record, so integrators without an array can have it
};

struct SpecialisationTraits {
    bool is_generic = false;  // one kernel for every scene
    bool by_matrix = false;   // every object is met through its matrix: another intersection than that of kernels/
};

struct LaunchTraits {
    bool is_captured = false;  // a batch of samples is a CUDA graph
    bool loops = false;        // the graph holds a loop over the segments that ends with the last path
};

struct ArithmeticTraits {
    bool is_approximate = false;  // division and square root are approximate: tolerances of cases do not cover that
};

struct PrecisionTraits {
    std::uint32_t real_bytes = 4;  // of the numbers of a path
    bool intersects_in_double = false;

    constexpr bool is_double() const { return real_bytes == 8; }
    constexpr bool is_mixed() const { return !is_double() && intersects_in_double; }
    constexpr bool is_single() const { return !is_double() && !intersects_in_double; }
};

struct RobustnessTraits {
    bool is_naive = false;
};

struct AcceleratorTraits {
    bool has_tree = true;              // made by a choice of the axis builder
    bool builds_itself = false;        // it has none of those, but one of its own
    bool checks_large_scenes = false;  // the reference where every triangle in turn would take too long
    bool has_steps = false;            // others may put its steps in order: variants/acceleration/walk.h
};

struct BuilderTraits {
    bool splits_primitives = false;  // a primitive may be in several leaves
};

struct TraversalTraits {
    bool is_accelerators_own = false;  // with a stack in local memory it is the accelerator's own loop
    bool needs_own_kernel = false;
};

struct TraversalStackTraits {
    bool is_in_thread = false;  // in its local memory alone
};

struct LevelsTraits {
    bool is_flat = false;  // one tree over the triangles of all objects, in the accelerator's format
};

struct LightSamplingTraits {
    bool is_by_solid_angle = true;  // as every shape's own function does it
};

struct DevicesTraits {
    std::uint32_t count = 1;
};

struct PartitionTraits {
    bool is_by_rows = false;  // each device has every sample of its own rows of pixels; otherwise of all pixels some
    bool is_dynamic = false;  // a device that is done takes more
};

struct LightSelectionTraits {
    bool is_uniform = true;
};

struct SubsurfaceSamplingTraits {
    bool is_classical = true;
};

// What a descriptor holds: nothing (the defaults of its axis), or the traits of its axis; in the order of axis_table.
using Traits =
    std::variant<std::monostate, IntegratorTraits, CompactionTraits, SortingTraits, SortKeyTraits, FirstBounceTraits,
                 DirectLightTraits, RouletteTraits, SamplerTraits, LayoutTraits, SpecialisationTraits, LaunchTraits,
                 ArithmeticTraits, PrecisionTraits, RobustnessTraits, AcceleratorTraits, BuilderTraits, TraversalTraits,
                 TraversalStackTraits, LevelsTraits, LightSamplingTraits, DevicesTraits, PartitionTraits,
                 LightSelectionTraits, SubsurfaceSamplingTraits>;
static_assert(std::variant_size_v<Traits> == axis_count + 1);

// The name of the choice that a variant has, for messages alone, and its traits.
template <class AxisTraits>
struct Chosen : AxisTraits {
    std::string_view name;
};

// A variant as its choices see it: the traits of its choice on every axis.
struct VariantTraits {
    Chosen<IntegratorTraits> integrator;
    Chosen<CompactionTraits> compaction;
    Chosen<SortingTraits> sorting;
    Chosen<SortKeyTraits> sort_key;
    Chosen<FirstBounceTraits> first_bounce;
    Chosen<DirectLightTraits> direct_light;
    Chosen<RouletteTraits> russian_roulette;
    Chosen<SamplerTraits> sampler;
    Chosen<LayoutTraits> layout;
    Chosen<SpecialisationTraits> specialisation;
    Chosen<LaunchTraits> launch;
    Chosen<ArithmeticTraits> arithmetic;
    Chosen<PrecisionTraits> precision;
    Chosen<RobustnessTraits> robustness;
    Chosen<AcceleratorTraits> accelerator;
    Chosen<BuilderTraits> builder;
    Chosen<TraversalTraits> traversal;
    Chosen<TraversalStackTraits> traversal_stack;
    Chosen<LevelsTraits> levels;
    Chosen<LightSamplingTraits> light_sampling;
    Chosen<DevicesTraits> devices;
    Chosen<PartitionTraits> partition;
    Chosen<LightSelectionTraits> light_selection;
    Chosen<SubsurfaceSamplingTraits> subsurface_sampling;
    std::map<std::string, std::uint32_t, std::less<>> tuning;  // Variant::tuning
};

// Why something does not apply: a key for programs and a text for people; empty: it applies.
struct Reason {
    std::string_view code = {};  // a short word that stays, for programs: "needs_queue"; empty: it applies
    std::string text = {};       // the sentence, for people
    std::string_view axis = {};  // of the choice that does not apply; empty: no choice's own (a tunable, a depth)

    bool empty() const { return code.empty(); }
};

}  // namespace pt
