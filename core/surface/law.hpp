// law.hpp - input and answer of a surface law.
//
// A surface law is a traction on faces from outside: a template over the number type, as interface
// laws and block laws are, with
//
//   static constexpr LawText text;  parameters;  state;       see records/law_declaration.hpp
//   static const char* contradiction(const Real* parameters);  why they do not fit, or null
//   static Law read(const auto& number);                       number(k): its k-th parameter
//   Vec3<T> respond(const SurfacePoint<T>& at, T* state) const;
//
// and, where it resists being displaced, the stiffness from which the stable step follows:
//
//   static Real stiffness(const Real* parameters);             [Pa/m]
//
// and, where it is a dashpot to the ground, along the normal of the start and across it:
//
//   static Impedance impedance(const Real* parameters, const Impedance& rock);
#pragma once

#include <array>

#include "core/base/math.hpp"
#include "core/records/law_declaration.hpp"

namespace cdem {

/// Density times wave speeds, along a normal and across it  [kg/(m2 s)].
struct Impedance {
  Real normal, shear;
};

/// A vertex of a face on which a law acts.
template <class T>
struct SurfacePoint {
  Vec3<T> position;      // [m]
  Vec3<T> displacement;  // since the entry of the case began to act  [m]
  Vec3<T> velocity;      // half a step ago  [m/s]
  Vec3<T> normal;        // outward, of the face as it lies now
  T factor;              // of the history of the entry, at this time
};

}  // namespace cdem
