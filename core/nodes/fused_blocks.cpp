// fused_blocks.cpp - see fused_blocks.hpp.
#include "core/nodes/fused_blocks.hpp"

#include <algorithm>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/elements/change_damping.hpp"
#include "core/elements/views.hpp"
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
  MassColumns mass = on_host(mass_columns(m, s));
  OnHost<const Index> nodes = on_host(e.nodes), support = on_host(m.support),
                      block_first = on_host(m.block_first), block_count = on_host(m.block_count),
                      corner_first = on_host(s.nodes.corner_first);
  NodePorts ports = on_host(node_ports(m, s));
  Index corners = e.corners;

  Index first_node(Index i) const { return nodes[i]; }
  /// The rows that a node sums after the rows of its element.
  Range bond_rows(Index node) const { return {corner_first[node], corner_first[node + 1]}; }
  bool is_lumped(Index i) const { return mass.row(first_node(i)) < 0; }
  bool is_fused(Index i) const {
    const Index first = first_node(i), row = mass.row(first);
    if (block_first[first] != first || block_count[first] != corners) return false;
    for (Index k = 0; k < corners; ++k) {
      const Index node = first + k;
      if (nodes[std::size_t(k) * e.stride + i] != node || !ports.is_plain(node) ||
          support[node] >= 0 || mass.row(node) != (row < 0 ? row : row + corners * k) ||
          mass.held(node))
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
  std::vector<Index> first((of.e.count + block_size - 1) / block_size + 1);
  for (const Index block : blocks) {
    Index most = 0;
    of.visit_nodes(block, [&](Index, Index, Index node) {
      const Range bonds = of.bond_rows(node);
      most = std::max(most, bonds.last - bonds.first);
    });
    first[block + 1] = most * of.corners * block_size;
  }
  for (std::size_t b = 1; b < first.size(); ++b) first[b] += first[b - 1];
  fused.row_first.assign(first);
  fused.row.renew(first.back());
  const auto rows = on_host(fused.row);
  const auto corner = on_host(of.s.nodes.corner);
  std::fill(rows.begin(), rows.end(), of.m.corner_rows);  // adds nothing
#pragma omp parallel for schedule(static) if (blocks.size() * block_size >= worth_threads)
  for (const Index block : blocks) {
    const Index most = (first[block + 1] - first[block]) / (of.corners * block_size);
    of.visit_nodes(block, [&](Index lane, Index k, Index node) {
      Index row = first[block] + k * most * block_size + lane;
      const Range bonds = of.bond_rows(node);
      for (Index c = bonds.first; c < bonds.last; ++c, row += block_size) rows[row] = corner[c];
    });
  }
}

void find_fused_elements(const Model& m, State& s, const ElementSet& e, ElementState& es) {
  FusedBlocks& fused = es.fused;
  const Elements of{m, s, e};
  const auto awake = on_host(es.awake);
  const Index count = Index(awake.size());
  std::vector<Flag> are_fused(count);
  std::vector<Index> blocks, lumped, general, all;  // the last of either masses
#pragma omp parallel for schedule(static) if (count * block_size >= worth_threads)
  for (Index b = 0; b < count; ++b) are_fused[b] = of.are_fused(awake[b]);
  for (Index b = 0; b < count; ++b) {
    const Index block = awake[b];
    if (!are_fused[b]) {
      general.push_back(block);
      continue;
    }
    (of.is_lumped(block * block_size) ? lumped : blocks).push_back(block);
    all.push_back(block);
  }
  fused.blocks.assign(blocks);
  fused.lumped.assign(lumped);
  fused.general.assign(general);
  list_rows(of, all, fused);
  if (all.empty()) return;
  s.nodes.fused.resize(m.node_count);
  const auto is_fused = on_host(s.nodes.fused);
  const auto force = on_host(s.nodes.force);
  for (const Index block : all)
    of.visit_nodes(block, [&](Index, Index, Index node) {
      is_fused[node] = 1;
      force[4 * std::size_t(node) + 3] = 0;  // no contact stiffens it any more
    });
}

}  // namespace

void find_fused_blocks(const Model& m, State& s) {
  NodeState& nodes = s.nodes;
  nodes.fused.resize(0);
  if (s.nodes.relax_mass.size() > 0 || m.formulation != Formulation::corotational || damps_rock(m))
    return;
  for_each_element_set(m, s,
                       [&]<class Shape>(ElementKind<Shape>, const ElementSet& e, ElementState& es) {
                         with_flow<Shape>(s, e, es, [&]<class Flow>(const Flow&) {
                           if constexpr (has_fused_kernel<Shape, Flow>)
                             find_fused_elements(m, s, e, es);
                           else
                             es.fused.general.assign(es.awake.data(), es.awake.size());
                         });
                       });
  if (nodes.fused.size() == 0) return;
  const Flag* fused = on_host(nodes.fused).data();
  std::vector<Index> general;
  for (const Index block : on_host(nodes.awake)) {
    const Index begin = block * block_size, end = std::min(begin + block_size, m.node_count);
    if (!std::all_of(fused + begin, fused + end, [](Flag f) { return f == 1; }))
      general.push_back(block);
  }
  nodes.general.assign(general);
}

}  // namespace cdem
