// A mesh as an accelerator on the host prepares it for itself (MeshView::native). Beside the search for one ray it may
// offer one for all lanes of a packet at once.
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

// Finds the closest hits of a packet's rays among the triangles of one object's mesh, and keeps each hit that is closer
// than its lane's, in the lanes with the flag `asks`. `origin`: ray origins as the object sees them. `enough`: by lane,
// the distance below which a hit ends the search and becomes -1 (NearerThan in kernels/intersect.h); 0: none does.
using MeetMeshInLanes = void (*)(Hits<float>& hits, const Lanes<std::uint32_t>& asks,
                                 const MeshInstance<float>& instance, std::uint32_t object,
                                 const Vectors<float>& origin, const Paths<float>& rays, const Lanes<float>& enough);

}  // namespace lanes

struct HostMesh {
    lanes::MeetMeshInLanes meet_in_lanes = nullptr;  // search for a packet; null: each of its rays is traced by itself
};

}  // namespace pt
