// release_pairs.hpp - kernels that release pairs.
#pragma once

#include "core/bonds/bonded_pairs.hpp"

namespace cdem {

/// Does a pair hold its faces together, and is it no hinge? Items of a list.
struct ListBonded {
  const Index* pairs;
  const Flag* status;

  template <class Act>
  CDEM_HD void visit(One item, const Act& act) const {
    if (PairStatus(status[pairs[item.i]]) == PairStatus::bonded) act(pairs[item.i]);
  }
};

/// Release the pairs of a list. Bonds of overlaps that are no hinges end later, when the search has
/// found the contacts that follow.
struct ReleasePairs {
  const Index* released;
  BondEnds ends;
  Flag* status;
  bool wait;  // do those that are no hinges?

  CDEM_HD void operator()(One item) const {
    const One pair{released[item.i]};
    if (!wait || PairStatus(status[pair.i]) == PairStatus::hinge) ends.end(pair);
    status[pair.i] = Flag(PairStatus::released);
    ends.pairs.jump.set(0, pair, 0);
    ends.pairs.jump_at_break.set(0, pair, -1);
  }
};

}  // namespace cdem
