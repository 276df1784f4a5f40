// bring_in.cpp - see bring_in.hpp.
#include "core/run/bring_in.hpp"

#include <algorithm>
#include <vector>

#include "core/bolts/bolts.hpp"
#include "core/bonds/initial_tractions.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "core/model/force_sets.hpp"
#include "core/run/take_out.hpp"
#include "core/water/water.hpp"

namespace cdem {

namespace {

/// Elements of these nodes forget what they have borne before; what they have lost stays.
void renew_elements(const Model& m, State& s, const Flag* comes) {
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    for (Index i = 0; i < e.count; ++i) {
      if (!comes[e.nodes[i]]) continue;
      for (Column<Real>* column : {&es.history, &es.yielded, &es.point_stress})
        for (std::size_t k = 0; k < column->size() / e.stride; ++k) (*column)[k * e.stride + i] = 0;
    }
  });
}

/// The same of the dilatation of tets and of its means at their nodes.
void renew_nodal_means(const Model& m, State& s, const Flag* comes) {
  const ElementSet& e = m.tet4;
  for (std::size_t i = 0; i < s.nodal.start.size(); ++i)
    if (comes[e.nodes[i]]) s.nodal.start[i] = 0;
  for (std::size_t i = 0; i < s.nodal.after.size(); ++i)
    if (comes[i]) s.nodal.after[i] = 0;
}

/// Bolts that are not installed yet have their grout in blocks that come in.
void renew_bolts(const BoltSet& b, BoltState& bs, const Flag* out) {
  for (Index i = 0; i < b.count; ++i) {
    if (bs.phase[i] != Flag(BoltPhase::waiting)) continue;
    for (Index n = b.first[i]; n < b.first[i + 1]; ++n) bs.grout_lost[n] = bs.bar_broken[n] = 0;
    cut_bolt(b, out, bs, i);
  }
}

/// Which faces a pair covers: those of which none of the pairs is released.
struct Covered {
  std::vector<Flag> touched, bare;  // of the blocks that come in, or beside them; by face
};

Covered covered_faces(const Model& m, const State& s, const Flag* comes) {
  Covered found{.touched = std::vector<Flag>(m.face_count),
                .bare = std::vector<Flag>(m.face_count)};
  for (Index f = 0; f < m.face_count; ++f) {
    found.touched[f] = comes[m.face_nodes[4 * f]];
    found.bare[f] = m.face_initially_exposed[f];
  }
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    for (Index i = 0; i < p.count; ++i) {
      const Index a = p.faces[2 * i], b = p.faces[2 * i + 1];
      const bool touched = comes[m.face_nodes[4 * a]] || comes[m.face_nodes[4 * b]];
      for (const Index face : {a, b}) {
        if (touched) found.touched[face] = 1;
        if (PairStatus(ps.status[i]) != PairStatus::bonded) found.bare[face] = 1;
      }
    }
  });
  return found;
}

}  // namespace

void place_nodes(State& s, const Flag* comes, const Real* position) {
  for (std::size_t i = 0; i < s.nodes.out.size(); ++i) {
    if (!comes[i]) continue;
    s.nodes.out[i] = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      s.nodes.motion[8 * i + axis] = position[3 * i + axis];
      s.nodes.motion[8 * i + 4 + axis] = 0;
    }
  }
}

void bring_in(Model& m, State& s, const Flag* comes, const Flag* bonded) {
  const Real before = stored_energy(m, s);
  renew_elements(m, s, comes);
  renew_nodal_means(m, s, comes);
  bond_again(m, s, comes, bonded);
  renew_bolts(m.bolts, s.bolts, s.nodes.out.data());
  Covered faces = covered_faces(m, s, comes);
  std::vector<Flag> hidden(m.face_count);
  for (Index f = 0; f < m.face_count; ++f) {
    if (!faces.touched[f] || s.nodes.out[m.face_nodes[4 * f]]) continue;
    if (faces.bare[f]) expose(s, f);
    hidden[f] = !faces.bare[f];
  }
  hide_faces(s, hidden);
  sort_exposed(s);
  s.taken_out += before - stored_energy(m, s);
  list_pairs_of_exposed(m, s, {.everything_awake = true}, true);
  change_water(m, s);
}

}  // namespace cdem
