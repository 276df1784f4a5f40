// corner_lists.cpp - see corner_lists.hpp.
#include "core/nodes/corner_lists.hpp"

#include <algorithm>
#include <vector>

#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"
#include "core/nodes/contact_corners.hpp"

namespace cdem {

void list_corners(const Model& m, State& s) {
  std::vector<Flag> released(m.corner_rows);
  for_each_row_set(m, s, [&](auto, const auto& set, const auto& state) {
    const auto is_active = activity(state);
    const auto for_each_corner_row = corner_rows_of(set);
    for (Index i = 0; i < set.count; ++i)
      if (!is_active(i)) for_each_corner_row(i, [&](Index row) { released[row] = 1; });
  });
  const auto all_first = on_host(m.corner_first), all = on_host(m.corner);
  std::vector<Index> first(m.node_count + 1), corner;
  for (Index i = 0; i < m.node_count; ++i) {
    for (Index c = all_first[i]; c < all_first[i + 1]; ++c)
      if (!released[all[c] < 0 ? ~all[c] : all[c]]) corner.push_back(all[c]);
    first[i + 1] = Index(corner.size());
  }
  s.nodes.corner_first.assign(first);
  s.nodes.corner.assign(corner);
}

void list_contact_corners(const Model& m, State& s) {
  const Index exposed = Index(s.search.exposed_face.size());
  list_rows({}, exposed, 4 * exposed, m.node_count,
            ContactCorners{.exposed_face = s.search.exposed_face.data(),
                           .face_nodes = m.face_nodes.data(),
                           .listed = s.search.outer.face_listed.data()},
            s.search.contact_first, s.search.contact_corner);
}

}  // namespace cdem
