// A film whose sums do not depend on the order of the samples: 64-bit fixed point, integer addition.
// The quantum is a power of two chosen from the scene's brightest source (film_scale), so a scene with emission x 2^k
// has the same film shifted by k bits.
#pragma once

#include "kernels/math.h"

namespace pt {

// Counts of faults met while a film was filled. Each fault is reported; none is repaired in silence.
struct FilmFaults {
    std::uint64_t nonfinite = 0;  // samples with a NaN or an infinity: left out of the sums
    std::uint64_t negative = 0;   // samples with a negative channel: summed unchanged
    std::uint64_t saturated = 0;  // samples beyond the film's limit: clamped to it

    PT_HD bool none() const { return nonfinite == 0 && negative == 0 && saturated == 0; }
    PT_HD FilmFaults& operator+=(const FilmFaults& other) {
        nonfinite += other.nonfinite;
        negative += other.negative;
        saturated += other.saturated;
        return *this;
    }
};

template <class T>
PT_HD inline void atomic_add(T* address, T value) {
#if defined(__CUDA_ARCH__)
    atomicAdd(reinterpret_cast<unsigned long long*>(address), static_cast<unsigned long long>(value));
#else
    __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
#endif
}

// The sum of some samples of one pixel, in the film's quanta.
struct FilmSum {
    std::int64_t x = 0, y = 0, z = 0;

    PT_HD FilmSum& operator+=(const FilmSum& other) {
        x += other.x;
        y += other.y;
        z += other.z;
        return *this;
    }
};

struct FilmView {
    std::int64_t* sums = nullptr;  // film sums in quanta, pixel-major, 3 channels
    FilmFaults* faults = nullptr;
    double scale = 1.0;  // quanta per unit of radiance, a power of two
    double limit = 0.0;  // largest quanta of one sample such that the sum of all samples cannot overflow
    // The film's `scale` and `limit` for radiance in single precision, where a product with a power of two is exact as
    // well. If single_limit is negative, single precision is not used.
    float single_scale = 1.0f;
    float single_limit = -1.0f;  // the largest float not above `limit`, the most quanta of one sample; negative: none

    // Converts one sample's radiance to quanta. Faults are counted; a sample that is not finite is left out.
    PT_HD FilmSum quanta(const Vec3<float>& radiance) const {
        using std::llrint;
        const float x = radiance.x * single_scale;
        const float y = radiance.y * single_scale;
        const float z = radiance.z * single_scale;
        // A NaN radiance fails each comparison with 0 and takes the slow path.
        const bool plain =
            x >= 0.0f && y >= 0.0f && z >= 0.0f && x <= single_limit && y <= single_limit && z <= single_limit;
        if (plain) {
            return {static_cast<std::int64_t>(llrint(x)), static_cast<std::int64_t>(llrint(y)),
                    static_cast<std::int64_t>(llrint(z))};
        }
        return quanta(Vec3<double>(radiance));
    }
    PT_HD FilmSum quanta(const Vec3<double>& radiance) const {
        const double x = radiance.x * scale;
        const double y = radiance.y * scale;
        const double z = radiance.z * scale;
        const double largest = max(absolute(x), max(absolute(y), absolute(z)));
        const double sum = x + y + z;
        if (!(absolute(sum) <= 1.7e308)) {
            atomic_add(&faults->nonfinite, std::uint64_t{1});
            return {};
        }
        if (x < 0 || y < 0 || z < 0) {
            atomic_add(&faults->negative, std::uint64_t{1});
        }
        if (largest > limit) {
            atomic_add(&faults->saturated, std::uint64_t{1});
        }
        return {quantise(x), quantise(y), quantise(z)};
    }

    PT_HD void add(std::uint32_t pixel, const FilmSum& sum) const {
        std::int64_t* const target = sums + 3 * static_cast<std::size_t>(pixel);
        if ((sum.x | sum.y | sum.z) != 0) {
            atomic_add(&target[0], sum.x);
            atomic_add(&target[1], sum.y);
            atomic_add(&target[2], sum.z);
        }
    }
    template <class Real>
    PT_HD void add(std::uint32_t pixel, const Vec3<Real>& radiance) const {
        add(pixel, quanta(radiance));
    }

    // Adds the sum of several samples of a pixel, given as radiance, to the film.
    template <class Real>
    PT_HD void add_sum(std::uint32_t pixel, const Vec3<Real>& sum) const {
        using std::llrint;
        const double x = static_cast<double>(sum.x) * scale;
        const double y = static_cast<double>(sum.y) * scale;
        const double z = static_cast<double>(sum.z) * scale;
        const double largest = max(absolute(x), max(absolute(y), absolute(z)));
        if (!(largest <= 0x1p62) || x != x || y != y || z != z) {
            atomic_add(&faults->nonfinite, std::uint64_t{1});
            return;
        }
        add(pixel, {static_cast<std::int64_t>(llrint(x)), static_cast<std::int64_t>(llrint(y)),
                    static_cast<std::int64_t>(llrint(z))});
    }

private:
    PT_HD std::int64_t quantise(double value) const {
        using std::llrint;
        return static_cast<std::int64_t>(llrint(clamp(value, -limit, limit)));
    }
};

// Sum of one pixel's samples in one thread before they go to the film: in quanta, so that order does not matter. A
// naive kernel sums radiance in its own precision, in the order of the samples.
template <class Config>
class PixelSum {
public:
    using Real = typename Config::Real;
    PT_HD void add(const FilmView& film, const Vec3<Real>& radiance) {
        if constexpr (has<Config>(Feature::naive)) {
            radiance_ += radiance;
        } else {
            quanta_ += film.quanta(radiance);
        }
    }
    PT_HD void finish(const FilmView& film, std::uint32_t pixel) const {
        if constexpr (has<Config>(Feature::naive)) {
            film.add_sum(pixel, radiance_);
        } else {
            film.add(pixel, quanta_);
        }
    }

private:
    FilmSum quanta_;
    Vec3<Real> radiance_{Real(0), Real(0), Real(0)};
};

}  // namespace pt
