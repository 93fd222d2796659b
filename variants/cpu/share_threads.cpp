#include "variants/cpu/share_threads.h"

#include <algorithm>

#include <omp.h>

namespace pt {

void share_threads(std::size_t processes) {
    omp_set_num_threads(std::max(1, omp_get_max_threads() / static_cast<int>(processes)));
}

}  // namespace pt
