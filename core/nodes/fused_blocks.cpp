// fused_blocks.cpp - see fused_blocks.hpp.
#include "core/nodes/fused_blocks.hpp"

#include <algorithm>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/fused_block.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

/// Elements of one shape, and how many corners each has.
struct Elements {
  const Model& m;
  const State& s;
  const ElementSet& e;
  MassColumns mass = mass_columns(m, s);
  Index corners = e.corners;

  Index first_node(Index i) const { return e.nodes[i]; }
  /// The rows that a node sums after those of its element.
  Range bond_rows(Index node) const {
    return {s.nodes.corner_first[node], s.nodes.corner_first[node + 1]};
  }
  /// Does any load but gravity act on nodes from `first` to before `last`?
  bool is_loaded(Index first, Index last) const {
    bool any = m.load_first[first] < m.load_first[last];
    any |= m.water.node_first.size() > 0 && m.water.node_first[first] < m.water.node_first[last];
    for (std::size_t k = 4 * std::size_t(first); k < 4 * std::size_t(last); ++k)
      any |= s.nodes.relief.size() > 0 && s.nodes.relief[k] != 0;
    return any;
  }
  bool is_lumped(Index i) const { return mass.row(first_node(i)) < 0; }
  bool is_fused(Index i) const {
    const Index first = first_node(i), last = first + corners, row = mass.row(first);
    if (m.block_first[first] != first || m.block_count[first] != corners ||
        is_loaded(first, last) || s.search.contact_first[first] < s.search.contact_first[last])
      return false;
    for (Index k = 0; k < corners; ++k) {
      const Index node = first + k;
      if (e.nodes[std::size_t(k) * e.stride + i] != node || m.support[node] >= 0 ||
          mass.row(node) != (row < 0 ? row : row + corners * k) || mass.held(node))
        return false;
    }
    return true;
  }
  /// Are all elements of a block fused, with masses of one kind?
  bool are_fused(Index block) const {
    const Index begin = block * block_size, end = std::min(begin + block_size, e.count);
    for (Index i = begin; i < end; ++i)
      if (!is_fused(i) || is_lumped(i) != is_lumped(begin)) return false;
    return begin < end;
  }
  template <class Visit>
  void visit_nodes(Index block, Visit&& visit) const {
    const Index begin = block * block_size, end = std::min(begin + block_size, e.count);
    for (Index i = begin; i < end; ++i)
      for (Index k = 0; k < corners; ++k) visit(i - begin, k, first_node(i) + k);
  }
};

/// List the rows that the nodes of fused blocks sum, see FusedRows.
void list_rows(const Elements& of, const std::vector<Index>& blocks, FusedBlocks& fused) {
  const State& s = of.s;
  Column<Index>&first = fused.row_first, &rows = fused.row;
  first.resize((of.e.count + block_size - 1) / block_size + 1);
  first.fill(0);
  for (const Index block : blocks) {
    Index most = 0;
    of.visit_nodes(block, [&](Index, Index, Index node) {
      const Range bonds = of.bond_rows(node);
      most = std::max(most, bonds.last - bonds.first);
    });
    first[block + 1] = most * of.corners * block_size;
  }
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  rows.resize(first[first.size() - 1]);
  rows.fill(of.m.corner_rows);  // adds nothing
#pragma omp parallel for schedule(static) if (blocks.size() * block_size >= worth_threads)
  for (const Index block : blocks) {
    const Index most = (first[block + 1] - first[block]) / (of.corners * block_size);
    of.visit_nodes(block, [&](Index lane, Index corner, Index node) {
      Index row = first[block] + corner * most * block_size + lane;
      const Range bonds = of.bond_rows(node);
      for (Index c = bonds.first; c < bonds.last; ++c, row += block_size)
        rows[row] = s.nodes.corner[c];
    });
  }
}

void find_fused_elements(const Model& m, State& s, const ElementSet& e, ElementState& es) {
  FusedBlocks& fused = es.fused;
  const Elements of{m, s, e};
  const Index count = Index(es.awake.size());
  std::vector<Flag> are_fused(count);
  std::vector<Index> all;  // of either masses
#pragma omp parallel for schedule(static) if (count * block_size >= worth_threads)
  for (Index b = 0; b < count; ++b) are_fused[b] = of.are_fused(es.awake[b]);
  for (Column<Index>* list : {&fused.blocks, &fused.lumped, &fused.general}) list->resize(0);
  for (Index b = 0; b < count; ++b) {
    const Index block = es.awake[b];
    if (!are_fused[b]) {
      fused.general.push(block);
      continue;
    }
    (of.is_lumped(block * block_size) ? fused.lumped : fused.blocks).push(block);
    all.push_back(block);
  }
  list_rows(of, all, fused);
  if (all.empty()) return;
  s.nodes.fused.resize(m.node_count);
  for (const Index block : all)
    of.visit_nodes(block, [&](Index, Index, Index node) {
      s.nodes.fused[node] = 1;
      s.nodes.force[4 * std::size_t(node) + 3] = 0;  // no contact stiffens it any more
    });
}

}  // namespace

void find_fused_blocks(const Model& m, State& s) {
  NodeState& nodes = s.nodes;
  nodes.fused.resize(0);
  if (s.nodes.relax_mass.size() > 0 || m.formulation != Formulation::corotational) return;
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState& es) {
                         if constexpr (has_fused_kernel<Shape>)
                           find_fused_elements(m, s, e, es);
                         else
                           es.fused.general.assign(es.awake.data(), es.awake.size());
                       });
  if (nodes.fused.size() == 0) return;
  nodes.general.resize(0);
  for (std::size_t b = 0; b < nodes.awake.size(); ++b) {
    const Index begin = nodes.awake[b] * block_size;
    const Index end = std::min(begin + block_size, m.node_count);
    const Flag* fused = nodes.fused.data();
    if (!std::all_of(fused + begin, fused + end, [](Flag f) { return f == 1; }))
      nodes.general.push(nodes.awake[b]);
  }
}

}  // namespace cdem
