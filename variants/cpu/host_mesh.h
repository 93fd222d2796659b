// What an accelerator of the host may offer beside the search for one ray: that for all lanes of a packet at once.
// Every mesh that an accelerator prepares for itself (MeshView::native) is one of these.
#pragma once

#include <cstdint>

namespace pt {

template <class Real>
struct MeshInstance;

namespace lanes {

template <class T>
struct Lanes;
template <class Real>
struct Vectors;
template <class Real>
struct Paths;
template <class Real>
struct Hits;

// Keeps in the hits of the lanes that ask the nearer of themselves and the triangles of one object's mesh. `origin`: of
// the rays, as the object sees it. `enough`: by lane, the distance below which a hit ends the search and becomes -1, as
// NearerThan has it (kernels/intersect.h); 0: nothing does.
using MeetMeshInLanes = void (*)(Hits<float>& hits, const Lanes<std::uint32_t>& asks,
                                 const MeshInstance<float>& instance, std::uint32_t object,
                                 const Vectors<float>& origin, const Paths<float>& rays, const Lanes<float>& enough);

}  // namespace lanes

struct HostMesh {
    lanes::MeetMeshInLanes meet_in_lanes = nullptr;  // null: each lane is searched for by itself
};

}  // namespace pt
