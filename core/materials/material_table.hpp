// material_table.hpp - the materials of a model, as kernels see them.
#pragma once

#include "core/base/views.hpp"
#include "core/materials/law.hpp"

namespace cdem {

/// The materials of the model, one entry each; an element holds the index of its own.
struct MaterialTable {
  const Real *lambda, *mu;  // [Pa]
  const Index* law;         // number in BlockLaws
  const Real* parameters;   // [material][BlockLaws::most_parameters]

  template <class Ids>
  CDEM_HD auto elastic(const Ids& material) const {
    return ElasticConstants<Number<Ids>>{look_up(lambda, material), look_up(mu, material)};
  }
  /// The lanes that have law `number`.
  template <Index number, class Ids>
  CDEM_HD Truth<Number<Ids>> has_law(const Ids& material) const {
    const auto own = [&](Index i) { return Real(law[i] == number); };
    return numbers_of(own, material) > Number<Ids>(0.5);
  }
};

}  // namespace cdem
