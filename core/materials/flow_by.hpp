// flow_by.hpp - response of a block law to a trial stress. Included where laws are instantiated:
// core/kernels/block_laws.cpp, and in CUDA each file of kernels that asks them.
#pragma once

#include "core/materials/laws.hpp"

namespace cdem {

/// The law of this type with the parameters of a material, or of one a lane, as strong as it is in
/// the state of the rows.
template <template <class> class Law, class Ids, class Rows>
CDEM_HD inline auto law_of(const MaterialTable& table, const Ids& material, const Rows& rows) {
  using T = Number<Ids>;
  const auto number = [&](Index k) {
    const auto own = [&](Index i) { return table.parameters[std::size_t(i) * material_row + k]; };
    return numbers_of(own, material);
  };
  constexpr Index falls = numbers_that_fall<Law>;
  if constexpr (falls > 0) {
    const auto piece = [&](Index k) { return number(law_numbers + k); };
    if (any_of(piece(0) > T(0.5))) {
      const T size = rows.size();
      return Law<T>::read([&](Index k) {
        return k < falls ? after_slip(number(k), k, size * rows.at(falls_with(k)), piece)
                         : number(k);
      });
    }
  }
  return Law<T>::read(number);
}

template <template <class> class Law, class T, class Ids, class Rows>
CDEM_OUT_OF_LINE void flow_by(const MaterialTable& table, const Ids& material, const Truth<T>& mine,
                              const Sym3<T>& trial, const Rows& rows, PointIncrement<T>& out) {
  const auto law = law_of<Law>(table, material, rows);
  if constexpr (requires { law.surely_elastic(trial); })
    if (!any_of(mine & !law.surely_elastic(trial))) return;
  const T none(0.0);
  if (!out.any) {
    out.any = true;
    out.strain = {none, none, none, none, none, none};
    for (Index k = 0; k < BlockLaws::most_state; ++k) out.state[k] = rows.at(k);
  }
  constexpr Index size = state_count<Law>;
  T own[size + 1];
  for (Index k = 0; k < size; ++k) own[k] = out.state[k];
  const Sym3<T> part = law.flow(table.elastic(material), trial, own);
  out.strain = select(mine, part, out.strain);
  for (Index k = 0; k < size; ++k) out.state[k] = select(mine, own[k], out.state[k]);
}

}  // namespace cdem
