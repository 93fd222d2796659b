// How an integrator's own kernel appends live paths, where no compaction kernel does. Shared by host and NVRTC.
#pragma once

namespace pt {

enum class AppendInKernel { no = 0, by_warp = 1, by_block = 2 };

}  // namespace pt
