// edge_edge_pairs.hpp - which edges of two patches may touch before the next rebuild.
#pragma once

#include "core/base/parallel.hpp"
#include "core/base/short_numbers.hpp"
#include "core/contact/broad_phase/moving_edge.hpp"
#include "core/contact/broad_phase/pair_items.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// The two edges of an item.
struct TwoPatchEdges {
  const PairContext& f;
  const PatchPair& pair;
  const Patch &a, &b;
  const Patch::Edge &of_a, &of_b;
  const MovingEdge &p, &q;

  CDEM_HD TwoPatchEdges(const PairContext& context, const PatchPair* pairs,
                        const MovingEdge* moving, const EdgeItem& item)
      : f(context),
        pair(pairs[item.pair]),
        a(f.patches[pair.one]),
        b(f.patches[pair.other]),
        of_a(a.edge[item.one]),
        of_b(b.edge[item.other]),
        p(moving[a.edge_first + item.one]),
        q(moving[b.edge_first + item.other]) {}
};

/// Call act(item) for the edges of a pair of patches that no plane holds apart.
struct ListEdgesOfPatches {
  PairContext f;
  const PatchPair* pairs;
  const MovingEdge* moving;
  Index first = 0;  // pair of row 0

  template <class Act>
  CDEM_HD void visit(One row, const Act& act) const {
    const Index place = first + row.i;
    const PatchPair& pair = pairs[place];
    const Patch &a = f.patches[pair.one], &b = f.patches[pair.other];
    Index at_b[12];  // faces at an edge of the second, as bits
    for (Index g = 0; g < b.edge_count; ++g)
      at_b[g] = may_touch(pair, 1, b, g) ? PatchPair::at(b.edge[g]) : 0;
    for (Index e = 0; e < a.edge_count; ++e) {
      const Index across = may_touch(pair, 0, a, e) ? pair.across(a.edge[e]) : 0;
      for (Index g = 0; across && g < b.edge_count; ++g)
        if (across & at_b[g])
          act(EdgeItem{
              .pair = place, .ways = 0, .one = unsigned(e), .other = unsigned(g), .sides = 0});
    }
  }

 private:
  CDEM_HD bool may_touch(const PatchPair& pair, Index of, const Patch& patch, Index e) const {
    return !(pair.edge[of] >> e & 1) && moving[patch.edge_first + e].side->sharp;
  }
};

/// May two edges touch before the next rebuild, on which sides of each other, and in which ways?
struct EdgesMayTouch {
  PairContext f;
  const PatchPair* pairs;
  const MovingEdge* moving;

  CDEM_HD bool operator()(EdgeItem& item) const {
    const TwoPatchEdges two(f, pairs, moving, item);
    const Real room = farthest_crossing(f.rules, two.a, two.b) +
                      last_step * norm(two.b.displacement - two.a.displacement);
    if (lines_are_far(two.p, two.q, room)) return false;
    const SharedEnds ends(two.p, two.q);
    if (ends.bonded || stay_together(two, ends)) return false;
    item.sides = unsigned(touching_sides(two, room));
    if (!item.sides) return false;
    item.ways = unsigned(ways_to_touch(two, ends));
    return item.ways != 0;
  }

 private:
  /// Do shared ends stay so close that the edges are no edges on each other, see
  /// ResolveTargetEdges?
  CDEM_HD bool stay_together(const TwoPatchEdges& two, const SharedEnds& ends) const {
    return ends.parted < f.rules.indentation * min_of(two.p.indented.length, two.q.indented.length);
  }
  /// On which sides of each other two edges may touch before the next rebuild, see TwoLines::sides:
  /// both where they may become parallel; 0 where they cannot touch. Edges in contact go on.
  CDEM_HD Index touching_sides(const TwoPatchEdges& two, Real room) const {
    const Vec3<Real> normal = cross(two.p.along, two.q.along);
    const Real sine = norm(normal), rotations = two.p.rotation + two.q.rotation;
    if (sine + rotations < parallel_edges) return 0;
    if (!(sine > rotations)) return distance2(two.p, two.q) > room * room ? 0 : 3;
    const TwoLines lines(two.p, two.q, normal, sine);
    const Index sides = lines.sides(f.rules);
    if (sides && lines.pass_by() && !in_contact(two.a, two.of_a, two.of_b.id) &&
        !in_contact(two.b, two.of_b, two.of_a.id))
      return 0;
    return sides;
  }
  /// Was an edge in contact with another one a step ago?
  CDEM_HD bool in_contact(const Patch& a, const Patch::Edge& p, Index edge) const {
    for (Index i = 0; i < p.faces; ++i) {
      const Index x = a.face[p.face[i]];
      for (Index c = f.edge_first[x]; c < f.edge_first[x + 1]; ++c) {
        const EdgeContact contact = EdgeContact::at(f.edge_contact, c);
        if (contact.mother == 4 * x + p.side[i] && contact.edge == edge) return true;
      }
    }
    return false;
  }
  /// In which ways two edges may touch, see EdgeWays, as bits.
  CDEM_HD Index ways_to_touch(const TwoPatchEdges& two, const SharedEnds& ends) const {
    const Patch::Edge &p = two.of_a, &q = two.of_b;
    Index ways = 0;
    for (Index i = 0; i < p.faces; ++i)
      for (Index j = 0; j < q.faces; ++j) {
        if (!two.pair.may_meet(0, p.face[i], q.face[j])) continue;
        const Index face_p = two.a.face[p.face[i]], face_q = two.b.face[q.face[j]];
        const ExposedFace &x = f.exposed[face_p], &y = f.exposed[face_q];
        // ends that stay together are no edges on each other, see ResolveTargetEdges
        if (ends.parted < f.rules.indentation * min_of(x.length, y.length)) continue;
        if (may_be_right(x, y, f.sides[4 * std::size_t(face_q) + q.side[j]]))
          ways |= 1 << EdgeWays::way(false, i, j);
        if (may_be_right(y, x, f.sides[4 * std::size_t(face_p) + p.side[i]]))
          ways |= 1 << EdgeWays::way(true, i, j);
      }
    return ways;
  }
  /// Is face y the right face of its side for a mother face x, or may it become so?
  CDEM_HD bool may_be_right(const ExposedFace& x, const ExposedFace& y,
                            const ExposedSide& q) const {
    const Real rotations = 2 * (x.rotation + y.rotation) + q.rotation_across;
    return q.across < 0 ||
           !(dot(x.normal, f.exposed[q.across].normal) < dot(x.normal, y.normal) - rotations);
  }
};

/// Write the pairs of edges as MarkNearEdges sees them: those of their ends first that began at the
/// same place, if any. Lists the faces that they are of.
struct WriteEdgePairs {
  PairContext f;
  PatchPair* pairs;
  const MovingEdge* moving;
  const EdgeItem* items;
  Index stride;
  Index *of, *codes;  // [2][pair] places among the edges of all patches; [pair]
  Short* room;        // [6][pair]
  bool alone;         // see raise

  CDEM_HD void operator()(One place) const {
    const EdgeItem& item = items[place.i];
    const TwoPatchEdges two(f, pairs, moving, item);
    list_faces(two, item);
    const SharedEnds ends(two.p, two.q);
    Index first = 0;
    while (ends.shared && !(ends.shared >> first & 1)) ++first;
    const Index first_p = first >> 1, first_q = first & 1;
    of[place.i] = two.a.edge_first + item.one;
    of[std::size_t(stride) + place.i] = two.b.edge_first + item.other;
    const Index sides = against(two.a, two.of_a, two.p.node[first_p]) |
                        against(two.b, two.of_b, two.q.node[first_q]) << 2;
    codes[place.i] = EdgeWays::code_of(item.ways, EdgeWays::turned(ends.shared, first_p, first_q),
                                       sides, first_p | first_q << 1);
    write_room(two, item, ends.shared, first_p != first_q, room + place.i);
  }

 private:
  CDEM_HD void list_faces(const TwoPatchEdges& two, const EdgeItem& item) const {
    std::uint64_t listed[2] = {0, 0};
    EdgeWays::visit(Flag(item.ways), [&](Index way) {
      const Index i = two.of_a.face[way >> 1 & 1], j = two.of_b.face[way & 1];
      if (EdgeWays::is_reverse(way))
        listed[1] |= PatchPair::bit(j, i);
      else
        listed[0] |= PatchPair::bit(i, j);
    });
    for (Index k = 0; k < 2; ++k) raise_bits(pairs[item.pair].listed[k], listed[k], alone);
  }
  /// Sides of an edge that do not begin at a node, as bits.
  CDEM_HD Index against(const Patch& patch, const Patch::Edge& edge, Index start) const {
    Index sides = 0;
    for (Index i = 0; i < edge.faces; ++i) {
      const Index face = f.exposed[patch.face[edge.face[i]]].face;
      sides |= (f.faces.vertex(face, edge.side[i]) != start) << i;
    }
    return sides;
  }
  CDEM_HD void write_room(const TwoPatchEdges& two, const EdgeItem& item, Index shared, bool turned,
                          Short* rooms) const {
    const SearchRules& rules = f.rules;
    const Indented edges = two.p.indented.and_of(two.q.indented);
    // seen along the cross product of the two as their ends are listed here
    const Real sign = item.sides == 3 ? 0 : ((item.sides == 1) != turned ? 1 : -1);
    const Real all[] = {round_up(1.000001 * rules.entry * min_of(two.a.length, two.b.length)),
                        round_up(edges.shift),
                        sign,
                        round_down(edges.inset),
                        round_down(shared ? 0.999999 * rules.indentation * edges.length : 0.0),
                        round_up(ways_part_soon(two.p, two.q) + 1e-6 * edges.length)};
    for (Index k = 0; k < 6; ++k) store(rooms + std::size_t(k) * stride, One{0}, all[k]);
  }
};

}  // namespace cdem
