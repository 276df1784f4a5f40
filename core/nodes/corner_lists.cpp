// corner_lists.cpp - see corner_lists.hpp.
#include "core/nodes/corner_lists.hpp"

#include <algorithm>
#include <vector>

#include "core/model/force_sets.hpp"

namespace cdem {

void list_corners(const Model& m, State& s) {
  std::vector<Flag> released(m.corner_rows);
  for_each_row_set(m, s, [&](auto, const auto& set, const auto& state) {
    for (Index i = 0; i < set.count; ++i) {
      if (!is_active(state, i)) for_each_corner_row(set, i, [&](Index row) { released[row] = 1; });
    }
  });
  Column<Index>&first = s.nodes.corner_first, &corner = s.nodes.corner;
  first.resize(m.node_count + 1);
  corner.resize(0);
  first[0] = 0;
  for (Index i = 0; i < m.node_count; ++i) {
    for (Index c = m.corner_first[i]; c < m.corner_first[i + 1]; ++c)
      if (!released[m.corner[c] < 0 ? ~m.corner[c] : m.corner[c]]) corner.push(m.corner[c]);
    first[i + 1] = Index(corner.size());
  }
}

void list_contact_corners(const Model& m, State& s) {
  Column<Index>&first = s.search.contact_first, &corner = s.search.contact_corner;
  first.resize(m.node_count + 1);
  first.fill(0);
  const auto visit = [&](auto&& at) {
    for (Index x = 0; x < Index(s.search.exposed_face.size()); ++x) {
      if (!s.search.outer.face_listed[x]) continue;
      const Index face = s.search.exposed_face[x];
      for (Index k = 0; k < 4; ++k)
        if (m.face_nodes[4 * face + k] >= 0) at(m.face_nodes[4 * face + k], 4 * x + k);
    }
  };
  visit([&](Index node, Index) { ++first[node + 1]; });
  for (Index i = 0; i < m.node_count; ++i) first[i + 1] += first[i];
  corner.resize(first[m.node_count]);
  std::vector<Index> next(first.data(), first.data() + m.node_count);
  visit([&](Index node, Index row) { corner[next[node]++] = row; });
}

}  // namespace cdem
