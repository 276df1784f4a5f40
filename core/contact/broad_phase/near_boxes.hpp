// near_boxes.hpp - which boxes overlap some others.
#pragma once

#include "core/base/column.hpp"
#include "core/contact/broad_phase/bounding_boxes.hpp"

namespace cdem {

/// Flag the boxes that overlap one of those with a flag; these keep it.
void flag_near(const Column<Box>& boxes, Column<Flag>& flags);

/// Does a box overlap one of a tree?
struct FlagNear {
  const Box* boxes;
  BoxTree tree;
  Flag* flags;

  CDEM_HD void operator()(One i) const {
    if (flags[i.i]) return;
    bool near = false;
    tree.query(boxes[i.i], [&](Index) { near = true; });
    flags[i.i] = near;
  }
};

}  // namespace cdem
