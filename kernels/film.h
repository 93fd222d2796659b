// A film whose sums do not depend on the order of the samples: 64-bit fixed point, integer addition.
// The quantum is a power of two chosen from the scene's brightest source (film_scale), so a scene with emission x 2^k
// has the same film shifted by k bits.
#pragma once

#include "kernels/math.h"

namespace pt {

// Faults met while a film was filled. Each is reported; none is repaired in silence.
struct FilmFaults {
    std::uint64_t nonfinite = 0;  // samples with a NaN or an infinity: left out of the sums
    std::uint64_t negative = 0;   // samples with a negative channel: summed as they are
    std::uint64_t saturated = 0;  // samples beyond the film's limit: clamped to it

    PT_HD bool none() const { return nonfinite == 0 && negative == 0 && saturated == 0; }
};

template <class T>
PT_HD inline void atomic_add(T* address, T value) {
#if defined(__CUDA_ARCH__)
    atomicAdd(reinterpret_cast<unsigned long long*>(address), static_cast<unsigned long long>(value));
#else
    __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
#endif
}

struct FilmView {
    std::int64_t* sums = nullptr;  // pixel-major, 3 channels
    FilmFaults* faults = nullptr;
    double scale = 1.0;  // quanta a unit of radiance, a power of two
    double limit = 0.0;  // largest quanta of one sample such that `samples` of them cannot overflow

    template <class Real>
    PT_HD void add(std::uint32_t pixel, const Vec3<Real>& radiance) const {
        const double x = static_cast<double>(radiance.x) * scale;
        const double y = static_cast<double>(radiance.y) * scale;
        const double z = static_cast<double>(radiance.z) * scale;
        const double largest = max(absolute(x), max(absolute(y), absolute(z)));
        const double sum = x + y + z;
        if (!(absolute(sum) <= 1.7e308)) {
            atomic_add(&faults->nonfinite, std::uint64_t{1});
            return;
        }
        if (x < 0 || y < 0 || z < 0) {
            atomic_add(&faults->negative, std::uint64_t{1});
        }
        if (largest > limit) {
            atomic_add(&faults->saturated, std::uint64_t{1});
        }
        atomic_add(&sums[3 * static_cast<std::size_t>(pixel) + 0], quantise(x));
        atomic_add(&sums[3 * static_cast<std::size_t>(pixel) + 1], quantise(y));
        atomic_add(&sums[3 * static_cast<std::size_t>(pixel) + 2], quantise(z));
    }

    PT_HD std::int64_t quantise(double quanta) const {
        using std::llrint;
        return static_cast<std::int64_t>(llrint(clamp(quanta, -limit, limit)));
    }
};

}  // namespace pt
