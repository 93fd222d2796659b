#include "variants/cpu/share_threads.h"

#include <algorithm>

#include <omp.h>

namespace pt {

int share_of_threads(std::size_t processes) {
    return processes == 0 ? omp_get_max_threads() : std::max(1, omp_get_max_threads() / static_cast<int>(processes));
}

void use_threads(int threads) { omp_set_num_threads(threads); }

}  // namespace pt
