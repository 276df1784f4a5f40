// bounding_boxes.hpp - which of many boxes overlap: a tree over their Morton order. Host code.
//
// Departure from the paper's static cells (Section 4.1, Fig. 10): a tree does not care how much the
// boxes differ in size, and was measured two to nine times faster than cells on the same boxes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/views.hpp"

namespace cdem {

struct Box {
  Real low[3], high[3];

  void include(const Vec3<Real>& p) {
    const Real x[3] = {p.x, p.y, p.z};
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
  void include(const Box& b) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], b.low[d]);
      high[d] = std::max(high[d], b.high[d]);
    }
  }
  void inflate(Real by) {
    for (int d = 0; d < 3; ++d) low[d] -= by, high[d] += by;
  }
  bool overlaps(const Box& b) const {
    bool apart = false;
    for (int d = 0; d < 3; ++d) apart = apart || low[d] > b.high[d] || b.low[d] > high[d];
    return !apart;
  }
  static Box nothing() { return {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}}; }
};

/// Interleave the low 21 bits of three integers.
inline std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
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

/// Groups of eight boxes, groups of eight groups, and so on, in Morton order of the centres.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes) {
    sort(boxes);
    std::vector<Box> level;
    for (const Index i : order_) level.push_back(boxes[i]);
    while (!level.empty()) {
      level_first_.push_back(groups_.size());
      std::vector<Box> above;
      for (std::size_t i = 0; i < level.size(); i += fan) {
        Group group;
        above.push_back(Box::nothing());
        for (std::size_t j = 0; j < fan && i + j < level.size(); ++j) {
          const Box& box = level[i + j];
          for (int d = 0; d < 3; ++d) group.low[d][j] = box.low[d], group.high[d][j] = box.high[d];
          group.used |= 1u << j;
          above.back().include(box);
        }
        groups_.push_back(group);
      }
      if (above.size() == 1) break;
      level = std::move(above);
    }
  }

  /// Call visit(i) for every box that overlaps `box`.
  template <class Visit>
  void query(const Box& box, Visit&& visit) const {
    if (!order_.empty()) descend(box, level_first_.size() - 1, 0, visit);
  }

 private:
  static constexpr std::size_t fan = 8;

  /// Eight boxes, each bound of theirs side by side.
  struct Group {
    alignas(64) Real low[3][fan] = {}, high[3][fan] = {};
    unsigned used = 0;  // places, as bits

    /// Which of them overlap a box, as bits. A box with NaN overlaps everything.
    unsigned overlaps(const Box& box) const {
      unsigned bits = 0;
      for (Index j = 0; j < Index(fan); j += lanes) {
        Mask apart{};
        for (int d = 0; d < 3; ++d) {
          apart = apart | (InTable{low[d], 0}.at(0, Lane{j}) > Pack(box.high[d])) |
                  (InTable{high[d], 0}.at(0, Lane{j}) < Pack(box.low[d]));
        }
        bits |= lane_bits(!apart) << j;
      }
      return bits & used;
    }
  };

  void sort(const std::vector<Box>& boxes) {
    Box all = Box::nothing();
    for (const Box& b : boxes) all.include(b);
    std::vector<std::pair<std::uint64_t, Index>> keys(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      std::uint64_t cell[3];
      for (int d = 0; d < 3; ++d) {
        const Real extent = std::max(all.high[d] - all.low[d], 1e-300);
        const Real middle = 0.5 * (boxes[i].low[d] + boxes[i].high[d]);
        cell[d] = std::uint64_t((middle - all.low[d]) / extent * 2097151.0);
      }
      keys[i] = {morton_code(cell[0], cell[1], cell[2]), Index(i)};
    }
    std::sort(keys.begin(), keys.end());
    for (const auto& key : keys) order_.push_back(key.second);
  }
  template <class Visit>
  void descend(const Box& box, std::size_t level, std::size_t i, Visit& visit) const {
    unsigned bits = groups_[level_first_[level] + i].overlaps(box);
    for (; bits; bits &= bits - 1) {
      const std::size_t j = fan * i + std::size_t(std::countr_zero(bits));
      if (level == 0)
        visit(order_[j]);
      else
        descend(box, level - 1, j, visit);
    }
  }

  std::vector<Index> order_;
  std::vector<Group> groups_;
  std::vector<std::size_t> level_first_;
};

}  // namespace cdem
