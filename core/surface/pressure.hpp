// pressure.hpp - pressure that follows the face: of gas, of a blast, of a lining.
#pragma once

#include "core/surface/law.hpp"

namespace cdem {

template <class T>
struct Pressure {
  static constexpr LawText text{.name = "pressure",
                                .meaning = "Pressure that follows the face as it moves and turns"};
  static constexpr std::array parameters{Parameter{
      .name = "pressure",
      .symbol = "p",
      .unit = "Pa",
      .meaning = "Pressure on the face, against its normal",
      .at_least = -std::numeric_limits<double>::infinity(),
  }};
  static constexpr std::array<StateVariable, 0> state{};
  static const char* contradiction(const Real*) { return nullptr; }

  T pressure;

  CDEM_HD static Pressure read(const auto& number) { return {.pressure = number(0)}; }
  CDEM_HD Vec3<T> respond(const SurfacePoint<T>& at, T*) const {
    return (-(at.factor * pressure)) * at.normal;
  }
};

}  // namespace cdem
