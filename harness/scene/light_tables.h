// The tables by which kernels/light_selection.h chooses one of many lights: an alias table over their power and a
// tree over them. The same on every machine: only + - * / and square roots of double make their numbers.
#pragma once

#include <span>
#include <vector>

#include "harness/scene/scene.h"
#include "kernels/scene_view.h"

namespace pt {

// What a light fills while the shutter is open, relative to the camera's eye, and what it emits, in any unit: area
// times mean radiance, and projected area along each axis times mean radiance.
struct LightExtent {
    Bounds<double> bounds;
    double power;
    Vec3d shown;
};

template <class Real>
struct LightTables {
    std::vector<LightSlot<Real>> slots;  // by number in `lights`
    std::vector<LightNode<Real>> nodes;
};

// Walker's alias table with probabilities of whole 2^-32nds of a slot, none 0 (Vose, "A Linear Algorithm for Generating
// Random Numbers with a Given Distribution", IEEE TSE 17(9), 1991); a tree split where what lights show times the
// surface of their box is least (Conty Estevez and Kulla 2018, eq. 3, without its cones). Up to 2^31 lights.
template <class Real>
LightTables<Real> light_tables(std::span<const LightExtent> lights);

extern template LightTables<float> light_tables(std::span<const LightExtent> lights);
extern template LightTables<double> light_tables(std::span<const LightExtent> lights);

}  // namespace pt
