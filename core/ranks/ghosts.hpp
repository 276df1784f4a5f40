// ghosts.hpp - kernels for nodes whose rows come from the ranks that own them.
#pragma once

#include "core/base/parallel.hpp"

namespace cdem {

/// Numbers of a row that are sent: `count` of them, or three, then three after the next.
struct SentNumbers {
  Index width;  // of a row
  Index count;
  bool skips = false;

  /// Position and velocity of a row of motion, without the numbers that pad them.
  CDEM_HD static SentNumbers motion() { return {.width = 8, .count = 6, .skips = true}; }
  CDEM_HD std::size_t at(Index node, Index k) const {
    return std::size_t(node) * width + k + (skips && k > 2 ? 1 : 0);
  }
};

/// Put rows of nodes into a message.
struct PackRows {
  SentNumbers numbers;
  const Index* nodes;
  const Real* rows;
  Real* message;
  CDEM_HD void operator()(One item) const {
    for (Index k = 0; k < numbers.count; ++k)
      message[std::size_t(item.i) * numbers.count + k] = rows[numbers.at(nodes[item.i], k)];
  }
};
/// Take them out of one.
struct UnpackRows {
  SentNumbers numbers;
  const Index* nodes;
  const Real* message;
  Real* rows;
  CDEM_HD void operator()(One item) const {
    for (Index k = 0; k < numbers.count; ++k)
      rows[numbers.at(nodes[item.i], k)] = message[std::size_t(item.i) * numbers.count + k];
  }
};

}  // namespace cdem
