// law_declaration.hpp - declaration of a law: its parameters and its state.
//
// A law is one header, core/interfaces/<law>.hpp or core/materials/<law>.hpp, and one entry in the
// laws.hpp beside it. Schema, checks, documentation, checkpoint, output fields and Python views are
// made from the declaration alone, see docs/contributing/adding_a_law.md.
#pragma once

#include <array>
#include <limits>

namespace cdem {

/// Name of a law in a case, and its description in one sentence.
struct LawText {
  const char* name;
  const char* meaning;
};

/// How a kernel gets a parameter.
enum class Form {
  number,        // as the case says it, in SI units
  tangent,       // an angle in a case [deg], its tangent in the kernel
  half_tangent,  // the tangent of half of it: sine and cosine follow without a library
};

/// The default of a parameter that a case must give.
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();

/// The default of a strength that has no limit where a case leaves it out.
inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// One parameter of a law.
struct Parameter {
  const char* name;
  const char* symbol;
  const char* unit;  // in a case
  const char* meaning;
  double at_least = 0;  // range in the unit of the case
  double below = std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
  double otherwise = required;  // where the case is silent
  const char* like = nullptr;   // then the default is the value of another parameter
  Form form = Form::number;
  bool is_strength = false;       // divided by a factor of safety (of an angle, the tangent is)
  bool is_factor = false;         // multiplied by one
  const char* choices = nullptr;  // words, with blanks between; the kernel gets the word's place
  bool bonds = false;             // above zero, it bonds faces that touch at the start
  int scatter = 0;  // power of the factor of a pair's strength that it has, see draws.hpp
};

/// A list of parameters, and then the parameters of a law built on it.
template <std::size_t count, class... More>
constexpr std::array<Parameter, count + sizeof...(More)> with_more(
    const std::array<Parameter, count>& list, const More&... more) {
  std::array<Parameter, count + sizeof...(More)> all{};
  std::size_t k = 0;
  for (const Parameter& p : list) all[k++] = p;
  ((all[k++] = more), ...);
  return all;
}

/// One state variable of a law. It may only grow: where several contacts share a history, the
/// largest of their numbers goes on.
struct StateVariable {
  const char* name;
  const char* unit;
  const char* meaning;
  double intact = 0;  // of a bond at the start
  double loose = 0;   // of a contact between faces that were never bonded
};

}  // namespace cdem
