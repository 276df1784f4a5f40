// law.hpp - input and answer of an interface law.
//
// A law is a template <class T> struct of its parameters, T a number or a pack, with
//
//   static constexpr LawText text;                     name in a case, meaning
//   static constexpr std::array<Parameter, n> parameters;
//   static constexpr std::array<StateVariable, n> state;
//   static Law read(number);                           number(k) is parameter k
//   JointAnswer<T> respond(const JointInput<T>&, T* state) const;
//   Borne<T> bears(const JointInput<T>&, const T* state) const;
//                                                      quick answer for an intact joint; may be
//                                                      left out
//   static const char* contradiction(const Real*);     why parameters do not fit, or nullptr;
//                                                      {name} stands for a value of the case
//   static Real rise_most(const Real*);                how far the stress-free gap may rise  [m]
//   static bool asks_area(const Real*);                does the answer depend on the area of a
//                                                      contact, or on ratios of tractions alone?
//                                                      Left out: it does
//   static std::array<Real, 2> steepest_fall(const Real*);
//                                                      how fast strength falls, normal and in
//                                                      shear  [Pa/m]; may be left out
//   static Real friction_fall(const Real*);            how fast friction falls with the speed, in
//                                                      which the law is explicit, at most  [s/m];
//                                                      may be left out
//   static std::array<Real, m> prepare(const Real*);   numbers that kernels read, from the
//                                                      parameters; may be left out. Then it is
//                                                      these that `read` and `rise_most` get
//   Closure<T> close(depth, stiffness) const;          the normal spring of a pressed joint, and
//   T depth(pressure, stiffness) const;                its inverse, where it is not straight: of
//                                                      a joint without tensile strength
//   static Real curve_end(const Real*, Real k_n);      the pressure from which on that spring is
//                                                      straight, with the stiffness k_n  [Pa]
//
// It speaks of tractions [Pa] and separations [m], never of forces and areas: bond points,
// semi-springs and semi-edges call the same law and bring their areas.
#pragma once

#include "core/base/lanes.hpp"
#include "core/records/law_declaration.hpp"

namespace cdem {

/// Stiffness of a joint, and its inverse: much is divided by it.
template <class T>
struct JointStiffness {
  T n, s;                        // [Pa/m]
  T compliance_n, compliance_s;  // [m/Pa]

  CDEM_HD static JointStiffness of(const T& n, const T& s) {
    const T one(1.0);
    return {.n = n, .s = s, .compliance_n = one / n, .compliance_s = one / s};
  }
};

/// Where a joint is. With `bond` = 0 the faces only touch.
template <class T>
struct JointInput {
  T opening;         // past the stress-free gap; < 0 is pressed  [m]
  T shear1, shear2;  // along the joint, less slip  [m]
  JointStiffness<T> stiffness;
  T damping;  // normal traction of the contact's dashpot, compression > 0  [Pa]
  T bond;     // 1 while bonded, then 0
  T risen;    // how far the stress-free gap lies above zero  [m]
  T rate1 = T(0.0), rate2 = T(0.0);  // of the slip in this step  [m/s]
  T dt = T(0.0);                     // that step; 0 at rest  [s]
  T has_area;  // 1 if the area is the joint's, so that a cohesion counts: at bond points,
               // and at contacts of laws that ask for it

  CDEM_HD T slip_rate() const { return sqrt_of(rate1 * rate1 + rate2 * rate2); }  // [m/s]
};

/// Tractions on the mother, or on the second face of a bond, after the law.
template <class T>
struct JointAnswer {
  T elastic;             // normal traction of the spring, compression > 0  [Pa]
  T normal;              // the same with the dashpot  [Pa]
  T shear1, shear2;      // [Pa]
  T stored_n, stored_s;  // energy in the springs  [J/m2]
  T rise;                // of the stress-free gap in this step  [m]
  T fracture;            // energy that the law spends on fracture while the bond holds  [J/m2]
  T bond;                // 1 while it still holds
  Truth<T> opens;        // the normal traction reached its limit
  T friction = T(0.0);   // the same on friction; of laws with state  [J/m2]
};

/// The same of an intact joint that holds; nothing but the tractions counts where it does not.
template <class T>
struct Borne {
  T normal, shear1, shear2;  // [Pa]
  T stored;                  // [J/m2]
  Truth<T> holds;
};

template <class M, class T>
CDEM_HD inline JointAnswer<T> select(const M& mask, const JointAnswer<T>& yes,
                                     const JointAnswer<T>& no) {
  return {.elastic = select(mask, yes.elastic, no.elastic),
          .normal = select(mask, yes.normal, no.normal),
          .shear1 = select(mask, yes.shear1, no.shear1),
          .shear2 = select(mask, yes.shear2, no.shear2),
          .stored_n = select(mask, yes.stored_n, no.stored_n),
          .stored_s = select(mask, yes.stored_s, no.stored_s),
          .rise = select(mask, yes.rise, no.rise),
          .fracture = select(mask, yes.fracture, no.fracture),
          .bond = select(mask, yes.bond, no.bond),
          .opens = Truth<T>((mask & yes.opens) | ((!mask) & no.opens)),
          .friction = select(mask, yes.friction, no.friction)};
}

}  // namespace cdem
