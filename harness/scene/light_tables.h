// The tables by which kernels/light_selection.h samples one of many lights: an alias table over their power and a light
// tree. The tables are the same on every machine, since only + - * / and square roots of double make their numbers.
#pragma once

#include <span>
#include <vector>

#include "harness/scene/scene.h"
#include "kernels/scene_view.h"

namespace pt {

// A light as its selection needs it: the bounding box that it sweeps while the shutter is open, relative to the
// camera's eye, its power (area times mean radiance, in any unit), and per axis projected area times mean radiance.
struct LightExtent {
    Bounds<double> bounds;
    double power;
    Vec3d shown;
};

template <class Real>
struct LightTables {
    std::vector<LightSlot<Real>> slots;  // slots of the alias table; slot i is that of lights[i]
    std::vector<LightNode<Real>> nodes;
};

// Builds both tables for light selection, for up to 2^31 lights. Walker's alias table has probabilities in whole
// 2^-32nds of a slot, none 0 (Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution", IEEE
// TSE 17(9), 1991). The light tree is split where projected area times radiance times the surface of the bounding box
// is least (Conty Estevez and Kulla 2018, eq. 3, without its cones).
template <class Real>
LightTables<Real> light_tables(std::span<const LightExtent> lights);

extern template LightTables<float> light_tables(std::span<const LightExtent> lights);
extern template LightTables<double> light_tables(std::span<const LightExtent> lights);

}  // namespace pt
