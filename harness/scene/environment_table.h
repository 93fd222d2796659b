// The tables by which kernels/environment_map.h looks light up and draws directions to it. The same on every machine:
// only + - * / of double make their numbers.
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
    EnvironmentMap<Real> map{};  // with pointers into the vectors
};

// `lights`: how many objects emit; the environment is one light more, drawn as often as each of them, or, where they
// are not drawn `uniformly`, as often as all together.
template <class Real>
std::unique_ptr<const EnvironmentTable<Real>> environment_table(const SceneEnvironment& environment,
                                                                std::uint32_t lights, bool uniformly);

extern template std::unique_ptr<const EnvironmentTable<float>> environment_table(const SceneEnvironment&, std::uint32_t,
                                                                                 bool);
extern template std::unique_ptr<const EnvironmentTable<double>> environment_table(const SceneEnvironment&,
                                                                                  std::uint32_t, bool);

}  // namespace pt
