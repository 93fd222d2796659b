// The tables by which kernels/environment_map.h evaluates and importance-samples an environment map. The tables are the
// same on every machine, since only + - * / of double make their numbers.
#pragma once

#include <memory>
#include <vector>

#include "harness/scene/scene.h"
#include "kernels/environment_map.h"

namespace pt {

template <class Real>
struct EnvironmentTable {
    std::vector<EnvironmentRow<Real>> rows;
    std::vector<EnvironmentTexel<Real>> texels;
    EnvironmentMap<Real> map{};  // environment map as kernels read it, with pointers into `rows` and `texels`
};

// Makes the sampling tables of an environment map. `lights` is the number of emitting objects. The environment counts
// as one light more: with `uniformly` it is sampled as often as each of them, otherwise in half of the light samples.
template <class Real>
std::unique_ptr<const EnvironmentTable<Real>> environment_table(const SceneEnvironment& environment,
                                                                std::uint32_t lights, bool uniformly);

extern template std::unique_ptr<const EnvironmentTable<float>> environment_table(const SceneEnvironment&, std::uint32_t,
                                                                                 bool);
extern template std::unique_ptr<const EnvironmentTable<double>> environment_table(const SceneEnvironment&,
                                                                                  std::uint32_t, bool);

}  // namespace pt
