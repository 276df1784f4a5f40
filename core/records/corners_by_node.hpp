// corners_by_node.hpp - the corners of all elements, and their nodes.
#pragma once

#include "core/base/views.hpp"

namespace cdem {

/// Corners of all elements, counted element by element through the sets.
struct ElementCorners {
  struct Set {
    InIndices nodes;
    Index first, count;  // corner, elements
    Index corners;       // of an element
  };
  Set sets[4];

  /// Call act(set, element) for the element of a corner.
  template <class Act>
  CDEM_HD void with_element(Index corner, const Act& act) const {
    for (const Set& set : sets)
      if (corner >= set.first && corner < set.first + set.count * set.corners)
        act(set, (corner - set.first) / set.corners);
  }
};

/// Corners by their node, see list_rows; item: an element, counted through the sets.
struct CornersByNode {
  ElementCorners all;

  template <class Act>
  CDEM_HD void visit(One element, const Act& act) const {
    Index i = element.i;
    for (const ElementCorners::Set& set : all.sets) {
      if (i >= 0 && i < set.count)
        for (Index k = 0; k < set.corners; ++k)
          act(set.nodes.at(k, i), set.first + i * set.corners + k);
      i -= set.count;
    }
  }
};

}  // namespace cdem
