// applied_lists.cpp - see applied_lists.hpp.
#include "core/model/applied_lists.hpp"

#include <vector>

namespace cdem {

namespace {

void list_rows(Index node_count, const std::vector<Index>& node, AppliedForces& of) {
  std::vector<Index> first(node_count + 1), row(node.size());
  for (const Index i : node) ++first[i + 1];
  for (Index i = 0; i < node_count; ++i) first[i + 1] += first[i];
  std::vector<Index> next(first);
  for (std::size_t r = 0; r < node.size(); ++r) row[next[node[r]]++] = Index(r);
  of.first.assign(first);
  of.row.assign(row);
  of.rows.resize(4 * node.size());
  of.sum.resize(4 * std::size_t(node_count));
  of.work.resize(node_count);
}

}  // namespace

void list_applied(const Model& m, State& s) {
  Index modules = 0;
  Modules::for_each_of<Port::applied>([&]<class Module>() {
    if (!Module::is_there(given_of<Module>(m))) return;
    ++modules;
    AppliedForces& of = applied_of<Module>(s);
    list_rows(m.node_count, Module::row_nodes(m, s), of);
    s.nodes.has_applied.resize(m.node_count);
    const auto has = on_host(s.nodes.has_applied);
    const auto first = on_host(of.first);
    for (Index i = 0; i < m.node_count; ++i) has[i] |= first[i] < first[i + 1];
  });
  if (modules > 1) s.nodes.applied.resize(4 * std::size_t(m.node_count));
}

}  // namespace cdem
