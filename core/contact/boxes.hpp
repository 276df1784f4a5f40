// boxes.hpp - which of many boxes overlap: a tree over their Morton order. Host code.
//
// Departure from the paper's static cells (Section 4.1, Fig. 10): a tree does not care how much the
// boxes differ in size, and was measured two to nine times faster than cells on the same boxes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/math.hpp"

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
    for (int d = 0; d < 3; ++d)
      if (low[d] > b.high[d] || high[d] < b.low[d]) return false;
    return true;
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
    level_first_.push_back(0);
    for (const Index i : order_) nodes_.push_back(boxes[i]);
    std::size_t first = 0;
    while (nodes_.size() - first > 1) {
      const std::size_t last = nodes_.size();
      level_first_.push_back(last);
      for (std::size_t i = first; i < last; i += fan) {
        Box sum = Box::nothing();
        for (std::size_t j = i; j < std::min(i + fan, last); ++j) sum.include(nodes_[j]);
        nodes_.push_back(sum);
      }
      first = last;
    }
  }

  /// Call visit(i) for every box that overlaps `box`.
  template <class Visit>
  void query(const Box& box, Visit&& visit) const {
    if (!order_.empty()) descend(box, level_first_.size() - 1, 0, visit);
  }

 private:
  static constexpr std::size_t fan = 8;

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
    if (!nodes_[level_first_[level] + i].overlaps(box)) return;
    if (level == 0) {
      visit(order_[i]);
      return;
    }
    const std::size_t below = level_first_[level] - level_first_[level - 1];
    for (std::size_t j = fan * i; j < std::min(fan * (i + 1), below); ++j)
      descend(box, level - 1, j, visit);
  }

  std::vector<Index> order_;
  std::vector<Box> nodes_;
  std::vector<std::size_t> level_first_;
};

}  // namespace cdem
