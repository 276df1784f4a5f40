// tangent.cpp - see tangent.hpp.
#include "core/rest/tangent.hpp"

#include <algorithm>
#include <numeric>

#include "core/bonds/views.hpp"
#include "core/contact/force/views.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/elements/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/views.hpp"
#include "core/rest/contact_matrix.hpp"
#include "core/rest/element_matrix.hpp"
#include "core/rest/pair_matrix.hpp"

namespace cdem {

namespace {

template <Index count>
ConformingBonds<count> bonds_of(PairKind<ConformingBonds<count>>, const Model& m, State& s,
                                const PairSet& p, PairState& ps) {
  return {.nodes = {s.nodes.motion.data()},
          .pair_nodes = {p.nodes.data(), p.stride},
          .pairs = pair_columns(m, p, ps),
          .indentation = count == 3 ? m.bond_indentation_triangle : m.bond_indentation_quad,
          .dt = s.dt_last,
          .sampled = false,
          .corner_force = {nullptr}};
}
OverlapBonds bonds_of(PairKind<OverlapBonds>, const Model& m, State& s, const PairSet&,
                      PairState&) {
  return overlap_bonds(m, s);
}

PressedContacts contacts_of(const Model& m, State& s) {
  return {.faces = face_columns(m, s),
          .geometry = face_geometry(s),
          .laws = contact_laws(m, s),
          .rules = m.rules,
          .springs = spring_columns(s),
          .edges = edge_columns(s)};
}

/// visit(matrix) for all elements, then for all pairs, then for all contacts.
template <class Visit>
void for_each_matrix(const Model& m, State& s, const Visit& visit) {
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState&) {
                         const auto columns = on_host(element_columns<Shape>(m, s, e));
                         for (Index i = 0; i < e.count; ++i)
                           visit(element_matrix<Shape>(columns, One{i}));
                       });
  for_each_pair_set(m, s, [&](auto kind, const PairSet& p, PairState& ps) {
    const auto bonds = on_host(bonds_of(kind, m, s, p, ps));
    for (Index i = 0; i < p.count; ++i) visit(pair_matrix(bonds, One{i}));
  });
  if (!has_contact_pairs(s)) return;
  const PressedContacts contacts = on_host(contacts_of(m, s));
  for (Index slot = 0; slot < 4 * Index(s.search.exposed_face.size()); ++slot)
    visit(contacts.spring_matrix(slot));
  for (Index place = 0; place < Index(s.edges.contact.size() / 4); ++place)
    visit(contacts.edge_matrix(place));
}

/// Springs of modules.
std::vector<NodeSpring> springs_of(const Model& m, State& s) {
  std::vector<NodeSpring> all;
  Modules::for_each_of<Port::rows>([&]<class Module>() {
    if constexpr (requires { Module::springs(m, s); }) {
      const std::vector<NodeSpring> own = Module::springs(m, s);
      all.insert(all.end(), own.begin(), own.end());
    }
  });
  return all;
}

bool is_zero(const Real* block) {
  return std::all_of(block, block + 9, [](Real number) { return number == 0; });
}

/// Sets of nodes that hang together.
class Joined {
 public:
  explicit Joined(Index count) : of_(count) { std::iota(of_.begin(), of_.end(), 0); }
  Index root(Index i) {
    while (of_[i] != i) i = of_[i] = of_[of_[i]];
    return i;
  }
  /// The least node of a set is its root.
  void join(Index a, Index b) {
    a = root(a), b = root(b);
    of_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> of_;
};

/// The rows and columns that have an entry. Joins the nodes of bodies that hang together by more
/// than springs of modules.
void find_entries(const Model& m, State& s, const std::vector<NodeSpring>& springs,
                  BlockRows& matrix, Joined& bodies) {
  std::vector<Index> first(m.node_count + 1);
  const auto for_each_entry = [&](const auto& act) {
    const auto visit = [&](const ItemMatrix& k, bool holds) {
      for (Index a = 0; a < k.count; ++a)
        for (Index b = 0; b < k.count; ++b)
          if (!is_zero(k.block[a][b])) act(k.node[a], k.node[b], holds);
    };
    for_each_matrix(m, s, [&](const ItemMatrix& k) { visit(k, true); });
    for (const NodeSpring& spring : springs) visit(ItemMatrix(spring), false);
    for (Index i = 0; i < m.node_count; ++i) act(i, i, true);  // also of a node that nothing holds
  };
  for_each_entry([&](Index row, Index column, bool holds) {
    ++first[row + 1];
    if (holds) bodies.join(row, column);
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Index> all(first.back()), next(first.begin(), first.end() - 1);
  for_each_entry([&](Index row, Index column, bool) { all[next[row]++] = column; });
  std::vector<Index> column, start{0};
  for (Index row = 0; row < m.node_count; ++row) {
    const auto begin = all.begin() + first[row], end = all.begin() + first[row + 1];
    std::sort(begin, end);
    column.insert(column.end(), begin, std::unique(begin, end));
    start.push_back(Index(column.size()));
  }
  matrix.first.assign(start);
  matrix.column.assign(column);
}

void add_blocks(const Model& m, State& s, const std::vector<NodeSpring>& springs,
                BlockRows& matrix) {
  const auto first = on_host(matrix.first), column = on_host(matrix.column);
  matrix.block.resize(column.size() * 9);
  const auto block = on_host(matrix.block);
  const auto add = [&](const ItemMatrix& k) {
    for (Index a = 0; a < k.count; ++a)
      for (Index b = 0; b < k.count; ++b) {
        if (is_zero(k.block[a][b])) continue;
        const Index row = k.node[a];
        const auto* place =
            std::lower_bound(&column[first[row]], &column[first[row + 1] - 1], k.node[b]);
        Real* sum = &block[std::size_t(place - column.data()) * 9];
        for (Index j = 0; j < 9; ++j) sum[j] += k.block[a][b][j];
      }
  };
  for_each_matrix(m, s, add);
  for (const NodeSpring& spring : springs) add(ItemMatrix(spring));
}

/// Components that may move: not given, of rock that is there, and of a body that a support holds.
std::vector<Flag> free_components(const Model& m, const State& s, Joined& bodies) {
  const SupportColumns supports = on_host(support_columns(m, s));
  const auto out = on_host(s.nodes.out);
  std::vector<Flag> held(m.node_count), free(3 * std::size_t(m.node_count));
  for (Index i = 0; i < m.node_count; ++i)
    for (Index axis = 0; axis < 3; ++axis)
      if (supports.given(i, axis)) held[bodies.root(i)] = 1;
  for (Index i = 0; i < m.node_count; ++i) {
    const bool there = held[bodies.root(i)] && !(out.size() > 0 && out[i]);
    for (Index axis = 0; axis < 3; ++axis)
      free[3 * std::size_t(i) + axis] = there && !supports.given(i, axis);
  }
  return free;
}

/// Nodes that intact points of conforming pairs hold together are one point.
void find_points(const Model& m, State& s, NodeSystem& t) {
  Joined joined(m.node_count);
  for_each_pair_set(m, s, [&](auto, const PairSet& p, const PairState& ps) {
    if (!conforms(p)) return;
    const auto nodes = on_host(p.nodes);
    const auto status = on_host(ps.status);
    const auto bond = on_host(ps.bond);
    const Index count = p.points;
    for (Index i = 0; i < p.count; ++i)
      for (Index k = 0; k < count && is_live(PairStatus(status[i])); ++k)
        if (bond[std::size_t(k) * p.point_stride + i] > 0.5)
          joined.join(nodes[std::size_t(k) * p.stride + i],
                      nodes[std::size_t(count + k) * p.stride + i]);
  });
  t.point.resize(m.node_count);
  for (Index i = 0; i < m.node_count; ++i) {
    const Index root = joined.root(i);
    t.point[i] = root == i ? t.points++ : t.point[root];
  }
}

/// The nodes of a small block are smoothed together, others one by one.
std::vector<Index> groups_of_nodes(const Model& m) {
  constexpr Index small = 8;  // nodes
  const auto block_first = on_host(m.block_first), block_count = on_host(m.block_count);
  std::vector<Index> first{0};
  for (Index i = 0; i < m.node_count;) {
    i += block_first[i] == i && block_count[i] <= small ? block_count[i] : 1;
    first.push_back(i);
  }
  return first;
}

/// Let components that may not move stand by themselves.
void hold(NodeSystem& t) {
  const auto first = on_host(t.matrix.first), column = on_host(t.matrix.column);
  const auto block = on_host(t.matrix.block);
  for (Index row = 0; row < t.matrix.rows(); ++row)
    for (Index e = first[row]; e < first[row + 1]; ++e)
      for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j)
          if (!t.free[3 * std::size_t(row) + i] || !t.free[3 * std::size_t(column[e]) + j])
            block[std::size_t(e) * 9 + 3 * i + j] = row == column[e] && i == j ? 1 : 0;
}

}  // namespace

NodeSystem tangent_of(const Model& m, State& s) {
  const Transfer transfer;
  NodeSystem t;
  t.matrix.columns = m.node_count;
  const std::vector<NodeSpring> springs = springs_of(m, s);
  Joined bodies(m.node_count);
  find_entries(m, s, springs, t.matrix, bodies);
  add_blocks(m, s, springs, t.matrix);
  t.free = free_components(m, s, bodies);
  find_points(m, s, t);
  hold(t);
  t.group_first = groups_of_nodes(m);
  for (Index i = 0; i < m.node_count; ++i) {
    const Real* x = on_host(s.nodes.motion).data() + 8 * std::size_t(i);
    t.place.push_back({x[0], x[1], x[2]});
  }
  return t;
}

}  // namespace cdem
