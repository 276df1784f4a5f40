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
  const Index exposed = Index(s.search.exposed_face.size());
  list_rows({}, exposed, 4 * exposed, m.node_count,
            ContactCorners{.exposed_face = s.search.exposed_face.data(),
                           .face_nodes = m.face_nodes.data(),
                           .listed = s.search.outer.face_listed.data()},
            s.search.contact_first, s.search.contact_corner);
}

}  // namespace cdem
