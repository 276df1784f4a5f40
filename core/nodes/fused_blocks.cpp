// fused_blocks.cpp - see fused_blocks.hpp.
#include "core/nodes/fused_blocks.hpp"

#include "core/base/primitives.hpp"
#include "core/elements/change_damping.hpp"
#include "core/elements/views.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/fused_block.hpp"
#include "core/nodes/fused_elements.hpp"
#include "core/nodes/views.hpp"

namespace cdem {

namespace {

Index blocks_in(Index items) { return items / block_size + (items % block_size > 0); }

void take_items(const Column<Index>& from, Column<Index>& into) {
  into.renew(from.size());
  for_each_item({}, Index(from.size()), TakeItems{nullptr, from.data(), into.data()});
}

FusedElements elements_of(const Model& m, const State& s, const ElementSet& e) {
  return {.count = e.count,
          .corners = e.corners,
          .nodes = {e.nodes.data(), e.stride},
          .support = m.support.data(),
          .block_first = m.block_first.data(),
          .block_count = m.block_count.data(),
          .mass = mass_columns(m, s),
          .ports = node_ports(m, s)};
}

/// List the rows that the nodes of fused blocks sum, see FusedRows, and mark these nodes.
void list_rows(const Model& m, State& s, const FusedElements& of, const Column<Flag>& moved_by,
               FusedBlocks& fused) {
  const Index count = blocks_in(of.count);
  fused.row_first.renew(std::size_t(count) + 1);
  Index* const first = fused.row_first.data();
  if (fused.blocks.size() + fused.lumped.size() == 0) {
    set_all({}, count + 1, first, Index(0));
    return fused.row.renew(0);
  }
  for_each_item({}, count, CountFusedRows{of, moved_by.data(), first + 1});
  fused.row.renew(scan({}, count, first + 1, first));
  if (s.nodes.fused.size() == 0) {
    s.nodes.fused.renew(m.node_count);
    set_all({}, m.node_count, s.nodes.fused.data(), Flag(0));
  }
  for_each_item({}, count,
                PutFusedRows{.of = of,
                             .moved_by = moved_by.data(),
                             .corner = s.nodes.corner.data(),
                             .nothing = m.corner_rows,
                             .first = first,
                             .rows = fused.row.data(),
                             .fused = s.nodes.fused.data(),
                             .force = s.nodes.force.data()});
}

void find_fused_elements(const Model& m, State& s, const ElementSet& e, ElementState& es) {
  FusedBlocks& fused = es.fused;
  const FusedElements of = elements_of(m, s, e);
  const Index count = blocks_in(e.count);
  Column<Flag> moved_by;
  moved_by.renew(count);
  set_all({}, count, moved_by.data(), Flag(MovedBy::none));
  const Index awake = Index(es.awake.size());
  for_each_item({}, awake, FindMovers{of, es.awake.data(), moved_by.data()});
  const auto list = [&](MovedBy by, Column<Index>& blocks) {
    select_items({}, awake > 0 ? count : 0, IsMovedBy{moved_by.data(), by}, blocks);
  };
  list(MovedBy::fused, fused.blocks);
  list(MovedBy::fused_lumped, fused.lumped);
  list(MovedBy::general, fused.general);
  list_rows(m, s, of, moved_by, fused);
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
                             take_items(es.awake, es.fused.general);
                         });
                       });
  if (nodes.fused.size() == 0) return;
  Column<Index> list;
  select_items({}, Index(nodes.awake.size()),
               HasGeneralNode{m.node_count, nodes.awake.data(), nodes.fused.data()}, list);
  nodes.general.renew(list.size());
  for_each_item({}, Index(list.size()),
                TakeItems{list.data(), nodes.awake.data(), nodes.general.data()});
}

}  // namespace cdem
