#include "variants/builder/ploc.h"
#include "variants/builder/reinsertion.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::ploc_reinserted {
namespace {

// What more rounds bring is lost in what one mesh differs from another.
constexpr std::uint32_t rounds = 6;

const Registration registration(
    {
        .axis = "builder",
        .name = "ploc_reinserted",
        .summary = "ploc, whose subtrees are then put where the surfaces of all boxes add up to less",
        .origin = "Meister and Bittner 2018 (parallel reinsertion)",
        .backends = on_every_backend,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) {
         Pairing pairing = ploc::pair(boxes);
         reinsert(pairing, boxes, rounds);
         return assemble(pairing, boxes, 4, {});
     }}});

}  // namespace
}  // namespace pt::builder::ploc_reinserted
