// bring_in.cpp - see bring_in.hpp.
#include "core/run/bring_in.hpp"

#include <algorithm>
#include <vector>

#include "core/bonds/initial_tractions.hpp"
#include "core/contact/narrow_phase/exposed_faces.hpp"
#include "core/contact/pair_list/rebuild.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/applied.hpp"
#include "core/run/take_out.hpp"

namespace cdem {

namespace {

/// Reset the state of elements of these nodes; their losses stay.
void renew_elements(const Model& m, State& s, const Flag* comes) {
  for_each_element_set(m, s, [&](auto, const ElementSet& e, ElementState& es) {
    const auto nodes = on_host(e.nodes);
    for (Column<Real>* column :
         {&es.history, &es.yielded, &es.point_stress, &es.branch, &es.dashpot}) {
      const auto numbers = on_host(*column);
      for (Index i = 0; i < e.count; ++i)
        for (std::size_t k = 0; comes[nodes[i]] && k < numbers.size() / e.stride; ++k)
          numbers[k * e.stride + i] = 0;
    }
  });
}

/// The same of the dilatation of tets and of its means at their nodes.
void renew_nodal_means(const Model& m, State& s, const Flag* comes) {
  const auto nodes = on_host(m.tet4.nodes);
  const auto start = on_host(s.nodal.start), after = on_host(s.nodal.after);
  for (std::size_t i = 0; i < start.size(); ++i)
    if (comes[nodes[i]]) start[i] = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    if (comes[i]) after[i] = 0;
}

/// Faces covered by pairs: faces without a released pair.
struct Covered {
  std::vector<Flag> touched, bare;  // of the blocks that come in, or beside them; by face
};

Covered covered_faces(const Model& m, const State& s, const Flag* comes) {
  Covered found{.touched = std::vector<Flag>(m.face_count),
                .bare = std::vector<Flag>(m.face_count)};
  const auto face_nodes = on_host(m.face_nodes);
  const auto initially_exposed = on_host(m.face_initially_exposed);
  for (Index f = 0; f < m.face_count; ++f) {
    found.touched[f] = comes[face_nodes[4 * f]];
    found.bare[f] = initially_exposed[f];
  }
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    const auto faces = on_host(p.faces);
    const auto status = on_host(ps.status);
    for (Index i = 0; i < p.count; ++i) {
      const Index a = faces[2 * i], b = faces[2 * i + 1];
      const bool touched = comes[face_nodes[4 * a]] || comes[face_nodes[4 * b]];
      for (const Index face : {a, b}) {
        if (touched) found.touched[face] = 1;
        if (PairStatus(status[i]) != PairStatus::bonded) found.bare[face] = 1;
      }
    }
  });
  return found;
}

}  // namespace

void place_nodes(State& s, const Flag* comes, const Real* position) {
  const auto out = on_host(s.nodes.out);
  const auto motion = on_host(s.nodes.motion);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!comes[i]) continue;
    out[i] = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      motion[8 * i + axis] = position[3 * i + axis];
      motion[8 * i + 4 + axis] = 0;
    }
  }
}

void bring_in(Model& m, State& s, const Flag* comes, const Flag* bonded) {
  const Real before = stored_energy(m, s);
  renew_elements(m, s, comes);
  renew_nodal_means(m, s, comes);
  bond_again(m, s, comes, bonded);
  const auto out = on_host(s.nodes.out);
  Modules::for_each_of<Port::rows>([&]<class Module>() {
    Module::bring_in(given_of<Module>(m), state_of<Module>(s), out.data());
  });
  const Covered faces = covered_faces(m, s, comes);
  Column<Flag> open = open_faces(s);
  const auto opens = on_host(open);
  const auto face_nodes = on_host(m.face_nodes);
  for (Index f = 0; f < m.face_count; ++f)
    if (faces.touched[f] && !out[face_nodes[4 * f]]) opens[f] = faces.bare[f];
  change_exposed(m, s, open);
  s.taken_out += before - stored_energy(m, s);
  list_pairs_of_exposed(m, s, {.everything_awake = true}, true);
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if constexpr (requires { Module::renew(m, s, comes); }) Module::renew(m, s, comes);
  });
  change_applied(m, s);
}

}  // namespace cdem
