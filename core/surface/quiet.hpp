// quiet.hpp - a face that lets waves out, of Lysmer & Kuhlemeyer (1969).
#pragma once

#include "core/surface/law.hpp"

namespace cdem {

/// Dashpots rho c_p along the normal and rho c_s across it, of the rock behind the face. The engine
/// takes them implicitly, see nodes/dashpots.hpp; as a traction the law gives none.
template <class T>
struct Quiet {
  static constexpr LawText text{.name = "quiet",
                                .meaning = "Viscous boundary that absorbs outgoing waves"};
  static constexpr std::array<Parameter, 0> parameters{};
  static constexpr std::array<StateVariable, 0> state{};
  static const char* contradiction(const Real*) { return nullptr; }
  static Impedance impedance(const Real*, const Impedance& rock) { return rock; }

  CDEM_HD static Quiet read(const auto&) { return {}; }
  CDEM_HD Vec3<T> respond(const SurfacePoint<T>&, T*) const {
    const T none(0.0);
    return {none, none, none};
  }
};

}  // namespace cdem
