// near_boxes.hpp - which boxes overlap some others.
#pragma once

#include "core/base/column.hpp"
#include "core/contact/broad_phase/bounding_boxes.hpp"

namespace cdem {

/// Flag the boxes that are near one of those with a flag: no farther from it, along each axis, than
/// twice the smaller reach of the two  [m]. Those with a flag keep it.
void flag_near(const Column<Box>& boxes, const Column<Real>& reach, Column<Flag>& flags);

/// Is a box near one of a tree?
struct FlagNear {
  const Box* boxes;
  const Real* reach;
  BoxTree tree;         // of the boxes to be near, with room for their reach
  const Index* others;  // their numbers
  Flag* flags;

  CDEM_HD void operator()(One i) const {
    if (flags[i.i]) return;
    Box box = boxes[i.i];
    box.inflate(reach[i.i]);
    bool near = false;
    tree.query(box, [&](Index place) {
      const Index other = others[place];
      Box room = boxes[i.i];
      room.inflate(2 * min_of(reach[i.i], reach[other]));
      near = near || room.overlaps(boxes[other]);
    });
    flags[i.i] = near;
  }
};

}  // namespace cdem
