// edge_rows.hpp - kernels that change the list of the contacts of semi-edges between two searches.
#pragma once

#include "core/base/views.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// Contacts of semi-edges by their mother face, as read and as written.
struct EdgeRowsBefore {
  const Index *first, *contact;
  const Real *state, *reaction;
};
struct EdgeRows {
  Index* contact;
  Real *state, *reaction;

  CDEM_HD void copy(const EdgeRowsBefore& rows, Index from, const EdgeContact& as,
                    Index into) const {
    as.store(contact, into);
    for (std::size_t k = 0; k < 8; ++k) {
      state[8 * std::size_t(into) + k] = rows.state[8 * std::size_t(from) + k];
      reaction[8 * std::size_t(into) + k] = rows.reaction[8 * std::size_t(from) + k];
    }
  }
};

/// The contacts that go on where exposed faces have new places; item: new place.
struct KeptEdges {
  EdgeRowsBefore rows;
  const Index *before, *to;  // see PairPlaces

  template <class Act>
  CDEM_HD void visit(Index x, const Act& act) const {
    const Index old = before[x];
    if (old < 0) return;
    for (Index c = rows.first[old]; c < rows.first[old + 1]; ++c) {
      const EdgeContact was = EdgeContact::at(rows.contact, c);
      if (to[was.face] < 0) continue;
      act(c, EdgeContact{.mother = 4 * x + was.mother % 4,
                         .face = to[was.face],
                         .edge = was.edge,
                         .before = was.before});
    }
  }
};
struct CountKeptEdges {
  KeptEdges kept;
  Index* count;
  CDEM_HD void operator()(One x) const {
    Index sum = 0;
    kept.visit(x.i, [&](Index, const EdgeContact&) { ++sum; });
    count[x.i] = sum;
  }
};
struct MoveKeptEdges {
  KeptEdges kept;
  const Index* first;
  EdgeRows rows;
  CDEM_HD void operator()(One x) const {
    Index next = first[x.i];
    kept.visit(x.i,
               [&](Index from, const EdgeContact& as) { rows.copy(kept.rows, from, as, next++); });
  }
};

/// Row of a new contact: its mother face.
struct MotherOfEdge {
  const EdgeContact* contact;
  template <class Act>
  CDEM_HD void visit(One c, const Act& act) const {
    act(contact[c.i].mother / 4, c.i);
  }
};
/// Contacts that are new to the list of a mother face, each once; item: exposed face.
struct AddedEdges {
  EdgeRowsBefore rows;
  const EdgeContact* contact;  // new ones
  const Index *first, *added;  // those of a mother face

  template <class Act>
  CDEM_HD void visit(Index x, const Act& act) const {
    for (Index r = first[x]; r < first[x + 1]; ++r) {
      const EdgeContact one = contact[added[r]];
      bool has = false;
      for (Index c = rows.first[x]; c < rows.first[x + 1]; ++c)
        has = has || is_same(one, EdgeContact::at(rows.contact, c));
      for (Index q = first[x]; q < r; ++q) has = has || is_same(one, contact[added[q]]);
      if (!has) act(one);
    }
  }

 private:
  CDEM_HD static bool is_same(const EdgeContact& a, const EdgeContact& b) {
    return a.mother == b.mother && a.edge == b.edge;
  }
};
struct CountAddedEdges {
  AddedEdges added;
  Index* count;
  CDEM_HD void operator()(One x) const {
    Index sum = added.rows.first[x.i + 1] - added.rows.first[x.i];
    added.visit(x.i, [&](const EdgeContact&) { ++sum; });
    count[x.i] = sum;
  }
};
/// The contacts of a face, then the new ones, in this state and without force.
struct PutAddedEdges {
  AddedEdges added;
  ContactState begin;
  const Index* first;
  EdgeRows rows;
  CDEM_HD void operator()(One x) const {
    Index next = first[x.i];
    for (Index c = added.rows.first[x.i]; c < added.rows.first[x.i + 1]; ++c)
      rows.copy(added.rows, c, EdgeContact::at(added.rows.contact, c), next++);
    added.visit(x.i, [&](const EdgeContact& one) {
      one.store(rows.contact, next);
      begin.store(rows.state, next);
      for (std::size_t k = 0; k < 8; ++k) rows.reaction[8 * std::size_t(next) + k] = 0;
      ++next;
    });
  }
};

}  // namespace cdem
