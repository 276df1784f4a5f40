// node_frequency.hpp - bound of the frequencies that a node has a part in.
#pragma once

#include "core/nodes/mass.hpp"

namespace cdem {

/// Squared frequencies of a node, or of a block with a mass matrix: of its elements, and of its
/// bonds and contacts  [1/s2].
struct Frequency {
  Real element, contact;
  Index stiffest;  // of the nodes of the block
  bool free;       // does it count?
};

/// Bound of the squared frequencies of each node; of a block with a mass matrix the first node has
/// it. Nodes that do not count have -infinity.
struct NodeFrequency {
  MassColumns mass;
  SupportColumns supports;
  const Real* model_mass;                // [node] whatever masses move  [kg]
  const Real* least_mass;                // see Model; null: not known
  const Real* inverse_mass_bound;        // [node]
  const Real* frequency_squared;         // [node]
  const Real* lumped_frequency_squared;  // [node]
  const Real* force;                     // rows of 4
  const Real *potential, *bonds;         // stiffness that contacts may have, bonds have  [N/m]
  Real stiffer;  // moduli of the elements in fast motion over those of slow loading
  bool held;     // do nodes count that are held or driven in all directions?

  CDEM_HD Real operator()(One node) const {
    const Frequency all = of(node.i);
    return all.free ? all.element + all.contact : -infinity;
  }
  CDEM_HD Frequency of(Index i) const {
    const bool dense = mass.row(i) >= 0;
    const Index first = dense ? mass.block_first[i] : i;
    const Index last = dense ? first + mass.block_count[i] : i + 1;
    Frequency all{0, 0, i, held};
    if (dense && i != first) return {0, 0, i, false};
    Real stiffness = 0;
    for (Index j = first; j < last; ++j) {
      all.free = all.free || !is_held(j);
      if (const Real here = stiffness_at(j); here > stiffness) {
        stiffness = here;
        all.stiffest = j;
      }
      const Real own = mass.is_lumped(j) ? lumped_frequency_squared[j] : frequency_squared[j];
      all.element = max_of(stiffer * own, all.element);
    }
    // Gershgorin: a spring between two points adds at most twice its stiffness to a row
    all.contact = 2 * stiffness * (mass.is_lumped(i) ? 1 / model_mass[i] : inverse_mass_bound[i]);
    const Real part = dense ? part_of_bound({first, last}, all.element + all.contact) : 1;
    all.element *= part;
    all.contact *= part;
    return all;
  }
  /// Stiffness of bonds and contacts, including ones that may begin, on a node  [N/m].
  CDEM_HD Real stiffness_at(Index i) const { return max_of(potential[i], acting_at(i)) + bonds[i]; }
  /// Stiffness of contacts alone: of those that act, and without bonds of those that may begin too.
  CDEM_HD Real contacts_at(Index i) const {
    return bonds[i] > 0 ? acting_at(i) : max_of(potential[i], acting_at(i));
  }
  CDEM_HD Real acting_at(Index i) const { return force[std::size_t(i) * 4 + 3]; }

 private:
  CDEM_HD bool is_held(Index node) const {
    return supports.given(node, 0) && supports.given(node, 1) && supports.given(node, 2);
  }
  /// Factor on a bound of the squared frequency of a block with a mass matrix, from its nodes
  /// one by one: K <= diag(S + 2 k), M >= diag(least). 1 if no such diagonal is known.
  CDEM_HD Real part_of_bound(Range block, Real bound) const {
    if (!least_mass) return 1;
    Real largest = 0;
    for (Index j = block.first; j < block.last; ++j) {
      if (is_held(j)) continue;
      const Real elements = stiffer * model_mass[j] * lumped_frequency_squared[j];
      largest = max_of((elements + 2 * stiffness_at(j)) / least_mass[j], largest);
    }
    return largest < bound ? largest / bound : 1;
  }
};

/// The node, or block with a mass matrix, that has the highest frequency.
struct HighestNode {
  Real squared = -1;              // frequency [1/s2]; -1: no node counts
  Index node = -1;                // the stiffest of its nodes
  Real element = 0, contact = 0;  // its squared frequencies  [1/s2]
  Real bond_part = 0;             // of the stiffness there
};

/// Describe it; one item.
struct DescribeHighest {
  NodeFrequency nodes;
  const Most* most;
  HighestNode* answer;

  CDEM_HD void operator()(One) const {
    HighestNode highest;
    if (most->item >= 0) {
      const Frequency at = nodes.of(most->item);
      const Real stiffness = nodes.stiffness_at(at.stiffest);
      highest = {.squared = most->value,
                 .node = at.stiffest,
                 .element = at.element,
                 .contact = at.contact,
                 .bond_part = stiffness > 0 ? nodes.bonds[at.stiffest] / stiffness : 0};
    }
    *answer = highest;
  }
};

}  // namespace cdem
