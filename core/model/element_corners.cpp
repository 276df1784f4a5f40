// element_corners.cpp - see element_corners.hpp.
#include "core/model/element_corners.hpp"

#include "core/base/primitives.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

ElementCorners element_corners(const Model& m, const State& s) {
  ElementCorners all{};
  Index number = 0, corner = 0;
  for_each_element_set(m, s, [&](auto, const ElementSet& e, const ElementState&) {
    all.sets[number++] = {.nodes = {e.nodes.data(), e.stride},
                          .first = corner,
                          .count = e.count,
                          .corners = e.corners};
    corner += e.count * e.corners;
  });
  return all;
}

void list_element_corners(const Model& m, State& s) {
  const ElementCorners all = element_corners(m, s);
  list_rows_in_room({}, element_count(m, s), element_corner_count(m, s), m.node_count,
                    CornersByNode{all}, s.nodes.element_first, s.nodes.element_corner);
}

}  // namespace cdem
