// material_table.hpp - the materials of a model, as kernels see them.
#pragma once

#include "core/base/views.hpp"
#include "core/materials/law.hpp"

namespace cdem {

/// The materials of the model, one entry each; an element holds the index of its own.
struct MaterialTable {
  const Real *lambda, *mu;  // [Pa]
  const Index* law;         // number in BlockLaws
  const Real* parameters;   // [material][material_row]

  template <class Ids>
  CDEM_HD auto elastic(const Ids& material) const {
    return ElasticConstants<Number<Ids>>{look_up(lambda, material), look_up(mu, material)};
  }
  /// The number of each lane's law.
  template <class Ids>
  CDEM_HD Number<Ids> laws(const Ids& material) const {
    return numbers_of([&](Index i) { return Real(law[i]); }, material);
  }
};

}  // namespace cdem
