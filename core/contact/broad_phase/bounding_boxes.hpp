// bounding_boxes.hpp - which of many boxes overlap: a tree over their Morton order.
//
// Departure from the paper's static cells (Section 4.1, Fig. 10): a tree does not care how much the
// boxes differ in size, and was measured two to nine times faster than cells on the same boxes.
#pragma once

#include <cstdint>

#include "core/base/column.hpp"
#include "core/base/views.hpp"
#include "core/contact/broad_phase/box.hpp"

namespace cdem {

/// Interleave the low 21 bits of three integers.
CDEM_HD inline std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  const auto spread = [](std::uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
  };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/// Eight boxes, each bound of theirs side by side.
struct BoxGroup {
  static constexpr Index fan = 8;
  alignas(64) Real low[3][fan], high[3][fan];
  unsigned used;  // places, as bits

  CDEM_HD static BoxGroup none() {
    BoxGroup group;
    for (int d = 0; d < 3; ++d)
      for (Index j = 0; j < fan; ++j) group.low[d][j] = 0, group.high[d][j] = 0;
    group.used = 0;
    return group;
  }
  CDEM_HD void put(Index j, const Box& box) {
    for (int d = 0; d < 3; ++d) low[d][j] = box.low[d], high[d][j] = box.high[d];
    used |= 1u << j;
  }
  CDEM_HD Box whole() const {
    Box box = Box::nothing();
    for (Index j = 0; j < fan; ++j)
      if (used >> j & 1)
        box.include(Box{{low[0][j], low[1][j], low[2][j]}, {high[0][j], high[1][j], high[2][j]}});
    return box;
  }
  /// Which of them overlap a box, as bits. A box with NaN overlaps everything.
  CDEM_HD unsigned overlaps(const Box& box) const {
    unsigned bits = 0;
#if defined(__CUDACC__)
    for (Index j = 0; j < fan; ++j) {
      bool apart = false;
      for (int d = 0; d < 3; ++d)
        apart = apart || low[d][j] > box.high[d] || high[d][j] < box.low[d];
      bits |= unsigned(!apart) << j;
    }
#else
    for (Index j = 0; j < fan; j += lanes) {
      Mask apart{};
      for (int d = 0; d < 3; ++d) {
        apart = apart | (InTable{low[d], 0}.at(0, Lane{j}) > Pack(box.high[d])) |
                (InTable{high[d], 0}.at(0, Lane{j}) < Pack(box.low[d]));
      }
      bits |= lane_bits(!apart) << j;
    }
#endif
    return bits & used;
  }
};

/// Groups of eight boxes, groups of eight groups, and so on, in Morton order of the centres.
struct BoxTree {
  static constexpr Index most_levels = 11;  // 8^11 boxes are more than an Index can count
  const Index* order;                       // box at a place of the lowest groups
  const BoxGroup* groups;                   // level after level, from the lowest
  Index level_first[most_levels], levels;   // where the groups of a level begin

  /// Call visit(i) for every box that overlaps `box`.
  template <class Visit>
  CDEM_HD void query(const Box& box, const Visit& visit) const {
    if (levels == 0) return;
    Index at[most_levels];       // group of a level
    unsigned open[most_levels];  // places of it that are still to be visited, as bits
    Index level = levels - 1;
    at[level] = 0;
    open[level] = groups[level_first[level]].overlaps(box);
    while (level < levels) {
      if (!open[level]) {
        ++level;
        continue;
      }
      const Index j = lowest(open[level]), place = BoxGroup::fan * at[level] + j;
      open[level] &= open[level] - 1;
      if (level == 0) {
        visit(order[place]);
        continue;
      }
      at[--level] = place;
      open[level] = groups[level_first[level] + place].overlaps(box);
    }
  }

 private:
  CDEM_HD static Index lowest(unsigned bits) {
#if defined(__CUDA_ARCH__)
    return __ffs(int(bits)) - 1;
#else
    return __builtin_ctz(bits);
#endif
  }
};

/// The arrays of a tree.
class BoxTreeColumns {
 public:
  void make(Queue queue, const Column<Box>& boxes);
  BoxTree tree() const;

 private:
  Column<Index> order_;
  Column<std::uint64_t> codes_;
  Column<BoxGroup> groups_;
  Index level_first_[BoxTree::most_levels] = {}, levels_ = 0;
};

/// Put boxes, or groups, into groups of eight.
struct GroupBoxes {
  Index count;         // of boxes
  const Index* order;  // of them; null: as they are
  const Box* boxes;
  BoxGroup* groups;

  CDEM_HD void operator()(One g) const {
    BoxGroup group = BoxGroup::none();
    for (Index j = 0, i = BoxGroup::fan * g.i; j < BoxGroup::fan && i < count; ++j, ++i)
      group.put(j, boxes[order ? order[i] : i]);
    groups[g.i] = group;
  }
};
struct GroupGroups {
  Index count;  // of groups below
  const BoxGroup* below;
  BoxGroup* groups;

  CDEM_HD void operator()(One g) const {
    BoxGroup group = BoxGroup::none();
    for (Index j = 0, i = BoxGroup::fan * g.i; j < BoxGroup::fan && i < count; ++j, ++i)
      group.put(j, below[i].whole());
    groups[g.i] = group;
  }
};

/// Codes of the centres of boxes, in cells of the box that holds all.
struct FindMortonCodes {
  const Box* boxes;
  const BoxGroup* all;  // the highest group
  Index* order;
  std::uint64_t* codes;

  CDEM_HD void operator()(One i) const {
    const Box frame = all->whole();
    std::uint64_t cell[3];
    for (int d = 0; d < 3; ++d) {
      const Real extent = max_of(frame.high[d] - frame.low[d], 1e-300);
      const Real middle = 0.5 * (boxes[i.i].low[d] + boxes[i.i].high[d]);
      const Real place = (middle - frame.low[d]) / extent * 2097151.0;
      cell[d] = place > 0 ? std::uint64_t(min_of(place, 2097151.0)) : 0;
    }
    codes[i.i] = morton_code(cell[0], cell[1], cell[2]);
    order[i.i] = i.i;
  }
};

}  // namespace cdem
