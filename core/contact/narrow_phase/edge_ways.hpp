// edge_ways.hpp - two edges, the faces at them, and the ways in which these may touch.
#pragma once

#include <cstdint>

#include "core/base/lanes.hpp"

namespace cdem {

/// Ways to choose the sides of two edges that may touch: of the (at most two) faces at each edge
/// one is the mother's and one the target's.
struct EdgeWays {
  static constexpr Index count = 8;
  /// Is the mother's edge the second one?
  CDEM_HD static bool is_reverse(Index way) { return way & 4; }
  CDEM_HD static Index way(bool reverse, Index i, Index j) { return reverse << 2 | i << 1 | j; }
  /// Call act(way) for ways given as bits.
  template <class Do>
  CDEM_HD static void visit(Flag ways, const Do& act) {
    const unsigned rest = std::uint8_t(ways);
    for (Index way = 0; rest >> way; ++way)
      if (rest >> way & 1) act(way);
  }
  /// The mother's side and the target's, of the four: 0 and 1 at the first edge, 2 and 3 at the
  /// second.
  CDEM_HD static Index mother(Index way) { return is_reverse(way) ? 2 + (way & 1) : way >> 1 & 1; }
  CDEM_HD static Index target(Index way) { return is_reverse(way) ? way >> 1 & 1 : 2 + (way & 1); }
  /// The ways in which two edges may touch, as bits; which of their ends are shared; which of the
  /// four sides (of the first edge, then of the second) run against the edges; which of the
  /// edges begin where their first side ends.
  CDEM_HD static Index code_of(Index some, Index shared, Index against, Index turned) {
    return some | shared << count | against << (count + 4) | turned << (count + 8);
  }
  CDEM_HD static bool is_turned(Index code, Index edge) { return code >> (count + 8 + edge) & 1; }
  /// Ends that are shared, bit 2 a + b for end a of the one and b of the other, where the one, or
  /// the other, is run through backwards.
  CDEM_HD static Index turned(Index shared, bool one, bool other) {
    if (one) shared = (shared & 3) << 2 | shared >> 2;
    if (other) shared = (shared & 5) << 1 | (shared & 10) >> 1;
    return shared;
  }
  /// Did end a of the one and end b of the other begin at the same place in the mesh?
  template <class Ids>
  CDEM_HD static auto share(const Ids& code, Index a, Index b) {
    return has_bit(code, count + 2 * a + b);
  }
  /// Does side i of edge e run against the edge?
  template <class Ids>
  CDEM_HD static auto runs_against(const Ids& code, Index e, Index i) {
    return has_bit(code, count + 4 + 2 * e + i);
  }
  /// Are the two faces at edge e on either side of it: is each the other's ExposedRow::beside?
  template <class Ids>
  CDEM_HD static auto are_neighbours(const Ids& code, Index e) {
    return has_bit(code, count + 10 + e);
  }
  CDEM_HD static Index with_neighbours(Index code, Index e) { return code | 1 << (count + 10 + e); }
  /// Are there other faces at the edges, so that their contacts may be found through other pairs?
  CDEM_HD static bool have_others(Index code) { return has_bit(code, count + 12); }
  CDEM_HD static Index with_others(Index code) { return code | 1 << (count + 12); }
};

/// Two edges, or such a pair a lane: edge e with its ends, and with the (at most two) faces at it.
template <class Ids>
struct TwoEdges {
  Ids end[2][2];   // nodes
  Ids side[2][2];  // 4 * exposed face + side; the same twice where there is one face
  Ids code;        // see EdgeWays
  Ids before[4];   // by side as the mother: place of its contact one step ago, or -1
};

/// Sine of the angle between edges that never touch.
inline constexpr Real parallel_edges = 0.02;

/// How far a contact that goes on may cross beyond the ends of the sides, in parts of them.
CDEM_HD inline Real crossing_slack(Real indentation) { return 0.5 * indentation; }

}  // namespace cdem
