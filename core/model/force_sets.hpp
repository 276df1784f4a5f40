// force_sets.hpp - the sets of elements, bonded pairs and modules with rows, each once, and
// their functions for loops.
//
// Whatever puts forces on nodes through tiles or corner rows is a set. All loops over sets come
// from here. module.hpp lists the functions of a module.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/records/energy_terms.hpp"

namespace cdem {

// Selection of the kernels of a set; defined in elements/shapes.hpp and bonds/bonded_pairs.hpp.
struct Tet4;
struct Pyramid5;
struct Wedge6;
struct Hex8;
struct Hex8OnePoint;
template <Index count>
struct ConformingBonds;
struct OverlapBonds;

/// A kind of elements: its name, and how many nodes and Gauss points an element has.
template <class Shape>
struct ElementKind {
  const char* name;
  Index corners, points;
};

/// A kind of bonded pairs: its name, how many rows the point tables have, and how many corner rows
/// a pair has.
template <class Bonds>
struct PairKind {
  const char* name;
  Index points, corners;
};

/// A module, as the kind of a set.
struct ModuleKind {
  const char* name;
};

/// Call visit(kind, set, state) for every set of elements.
template <class M, class S, class Visit>
void for_each_element_set(M& m, S& s, Visit&& visit) {
  visit(ElementKind<Tet4>{.name = "tet4", .corners = 4, .points = 1}, m.tet4, s.tet4);
  visit(ElementKind<Pyramid5>{.name = "pyramid5", .corners = 5, .points = 5}, m.pyramid5,
        s.pyramid5);
  visit(ElementKind<Wedge6>{.name = "wedge6", .corners = 6, .points = 6}, m.wedge6, s.wedge6);
  if (m.hex8.hourglass.size() > 0)
    visit(ElementKind<Hex8OnePoint>{.name = "hex8", .corners = 8, .points = 1}, m.hex8, s.hex8);
  else
    visit(ElementKind<Hex8>{.name = "hex8", .corners = 8, .points = 8}, m.hex8, s.hex8);
}

/// The same for every set of bonded pairs.
template <class M, class S, class Visit>
void for_each_pair_set(M& m, S& s, Visit&& visit) {
  visit(PairKind<ConformingBonds<3>>{.name = "triangles", .points = 3, .corners = 3}, m.triangles,
        s.triangles);
  visit(PairKind<ConformingBonds<4>>{.name = "quads", .points = 4, .corners = 4}, m.quads, s.quads);
  visit(PairKind<OverlapBonds>{.name = "overlaps", .points = 1, .corners = 8}, m.overlaps,
        s.overlaps);
}

/// The same for the sets that put forces on nodes through corner rows, in the order of these.
template <class M, class S, class Visit>
void for_each_row_set(M& m, S& s, Visit&& visit) {
  for_each_pair_set(m, s, visit);
  Modules::for_each_of<Port::rows>([&]<class Module>() {
    visit(ModuleKind{.name = Module::name}, given_of<Module>(m), state_of<Module>(s));
  });
}

/// The same for all sets: elements put their forces on nodes through tiles.
template <class M, class S, class Visit>
void for_each_set(M& m, S& s, Visit&& visit) {
  for_each_element_set(m, s, visit);
  for_each_row_set(m, s, visit);
}

// Functions of the items of a set for host code. Each has the arrays of the set on the host, and
// holds as long as these.

/// is_active(item): does it act on its nodes? Pairs do until they are released.
inline auto activity(const PairState& s) {
  return [status = on_host(s.status)](Index pair) { return is_live(PairStatus(status[pair])); };
}

template <ModuleData S>
auto activity(const S& s) {
  return S::Module::activity(s);
}

/// for_each_corner_row(item, visit) calls visit(row) for the corner rows of an item.
inline auto corner_rows_of(const PairSet& p) {
  return [&p](Index pair, auto&& visit) {
    const Index first = p.corner_first + pair * p.corners;
    for (Index row = first; row < first + p.corners; ++row) visit(row);
  };
}
template <ModuleData Given>
auto corner_rows_of(const Given& given) {
  return [first = given.corner_first, for_each_row = Given::Module::rows_of(given)](Index item,
                                                                                    auto&& visit) {
    for_each_row(item, [&](Index, Index row) { visit(first + row); });
  };
}

/// Elements of all sets together.
inline Index element_count(const Model& m, const State& s) {
  Index count = 0;
  for_each_element_set(m, s,
                       [&](auto, const ElementSet& e, const ElementState&) { count += e.count; });
  return count;
}

/// Corners of all elements together.
inline Index element_corner_count(const Model& m, const State& s) {
  Index count = 0;
  for_each_element_set(
      m, s, [&](auto, const ElementSet& e, const ElementState&) { count += e.count * e.corners; });
  return count;
}

/// for_each_node(item, visit) calls visit(node) for the nodes of an item.
inline auto nodes_of(const Model&, const ElementSet& e) {
  return [&e, nodes = on_host(e.nodes)](Index item, auto&& visit) {
    for (Index k = 0; k < e.corners; ++k) visit(nodes[std::size_t(k) * e.stride + item]);
  };
}
inline auto nodes_of(const Model& m, const PairSet& p) {
  return [&p, nodes = on_host(p.nodes), faces = on_host(p.faces),
          face_nodes = on_host(m.face_nodes)](Index pair, auto&& visit) {
    if (conforms(p)) {
      for (Index k = 0; k < 2 * p.points; ++k) visit(nodes[std::size_t(k) * p.stride + pair]);
      return;
    }
    for (Index k = 0; k < 8; ++k) {
      const Index node = face_nodes[4 * faces[2 * pair + k / 4] + k % 4];
      if (node >= 0) visit(node);  // a triangle has no fourth
    }
  };
}
template <ModuleData Given>
auto nodes_of(const Model&, const Given& given) {
  return [for_each_row = Given::Module::rows_of(given)](Index item, auto&& visit) {
    for_each_row(item, [&](Index node, Index) { visit(node); });
  };
}

/// for_each_stiffness(item, visit) calls visit(node, stiffness [N/m]) for the largest stiffness of
/// an item at its nodes: it bounds their frequencies. The bound of elements is in the model
/// already.
inline auto stiffness_of(const Model& m, const PairSet& p) {
  return
      [&p, for_each_node = nodes_of(m, p), stiffness = on_host(p.stiffness), area = on_host(p.area),
       first = on_host(p.point_first), faces = on_host(p.faces), face_nodes = on_host(m.face_nodes),
       point_area = on_host(p.point_area), weights_a = on_host(p.weights_a),
       weights_b = on_host(p.weights_b)](Index pair, auto&& visit) {
        const Real k = std::max(stiffness[pair], stiffness[std::size_t(p.stride) + pair]);
        if (conforms(p)) {
          const Real share = k * area[pair] / p.points;
          for_each_node(pair, [&](Index node) { visit(node, share); });
          return;
        }
        for (Index c = first[pair]; c < first[pair + 1]; ++c)
          for (Index v = 0; v < 4; ++v) {
            const Index a = face_nodes[4 * faces[2 * pair] + v];
            const Index b = face_nodes[4 * faces[2 * pair + 1] + v];
            if (a >= 0) visit(a, k * point_area[c] * std::abs(weights_a[4 * c + v]));
            if (b >= 0) visit(b, k * point_area[c] * std::abs(weights_b[4 * c + v]));
          }
      };
}
template <ModuleData Given>
auto stiffness_of(const Model&, const Given& given) {
  return Given::Module::stiffness_of(given);
}

/// Call visit(term, column) for the columns that the terms of the energy ledger sum, see
/// energy_term.
template <class Visit>
void for_each_energy(const ElementState& s, Visit&& visit) {
  visit(energy_term("strain"), s.energy);
  visit(energy_term("damping"), s.damping_work);
  visit(energy_term("plastic"), s.plastic_work);
}
template <class Visit>
void for_each_energy(const PairState& s, Visit&& visit) {
  visit(energy_term("contact"), s.stored);
  visit(energy_term("friction"), s.friction);
  visit(energy_term("fracture"), s.fracture);
  visit(energy_term("damping"), s.damping_work);
}
template <ModuleData S, class Visit>
void for_each_energy(const S& s, Visit&& visit) {
  S::Module::for_each_energy(s, visit);
}

}  // namespace cdem
