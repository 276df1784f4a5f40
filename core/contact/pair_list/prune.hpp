// prune.hpp - kernels that take the inner pair list from the outer one.
//
// The tests of the narrow phase with room for all motion until the next pruning. Pairs that they
// leave out cannot touch before, so that the contacts found do not depend on them.
#pragma once

#include "core/base/parallel.hpp"
#include "core/base/short_numbers.hpp"
#include "core/contact/broad_phase/predicted_node.hpp"
#include "core/contact/narrow_phase/contact_columns.hpp"
#include "core/contact/narrow_phase/edge_pair.hpp"
#include "core/contact/narrow_phase/vertex_face.hpp"

namespace cdem {

/// Predict the motion of a node from here on, with the velocity that the outer list has for it. Its
/// skin allows the deviation that the present velocity makes beyond that one, and a little more; a
/// node that is hit leaves its skin and calls for a new list.
struct PredictInner {
  InMotion nodes;
  const Index* nodes_of;  // [predicted]
  const Real* outer;      // rows of PredictedNode
  Real time;              // for which it looks ahead  [s]
  Real* predicted;        // rows of PredictedNode
  Real* skin;             // [node]  [m]

  static constexpr Real more = 1.5,
                        least = 0.05;  // of the deviation, of the skin of the outer list

  CDEM_HD void operator()(One w) const {
    const Index node = nodes_of[w.i];
    const PredictedNode before = PredictedNode::at(outer + 8 * std::size_t(w.i));
    const Real deviation = more * time * norm(nodes.velocity(node) - before.velocity);
    const Real own = max_of(min_of(deviation, inner_skin * before.skin), least * before.skin);
    skin[node] = own;
    PredictedNode{nodes.position(node), before.velocity, own}.store(predicted +
                                                                    8 * std::size_t(w.i));
  }
};

/// Mark the pairs of vertex and face that may soon be in contact. One test stands for the
/// semi-springs in all faces at the vertex, and has room for the differences between them.
struct MarkNearFaces {
  InMotion nodes;
  FaceGeometry geometry;
  InIndices of;   // [2][pair]: node of the vertex; exposed face
  InBounds room;  // [6][pair]: highest above the face and lowest below it, farthest outside a
                  // side [m]; the sides, as bits, at which the surface may rise, so that it may lie
                  // outside; distance from the centre of three corners that it has then at most;
                  // how far the vertex may soon move as seen from the face, which all have room
                  // for: without skins  [m]
  const Real* rotation;  // [exposed] how much its normal may soon rotate  [rad]
  const Real* skin;      // [node]  [m]
  Flag* near;
  Short* motion;  // [pair] how far the vertex may soon move as seen from the face  [m]

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const auto vertex = of.at(0, p), face = of.at(1, p);
    const auto corners = geometry.vertices(face);
    const Vec3<T> v = nodes.position(vertex);
    const Vec3<T> x[4] = {nodes.position(corners.node[0]), nodes.position(corners.node[1]),
                          nodes.position(corners.node[2]), nodes.position(corners.node[3])};
    const Vec3<T> n = cross(x[2] - x[0], x[3] - x[1]);
    const T n2 = dot(n, n), gap = dot(n, v - x[0]);  // times |n|
    const T gap2 = gap * gap;
    const auto below = gap < T(0.0);
    const auto skin_at = [&](Index k) { return look_up(skin, corners.node[k]); };
    const T skins = look_up(skin, vertex) +
                    max_of(max_of(skin_at(0), skin_at(1)), max_of(skin_at(2), skin_at(3)));
    store(motion, p, round_up(room.at(5, p) + skins));
    const T most = select(below, room.at(1, p), room.at(0, p)) + skins;
    // how far a point above the face moves along it as the face rotates
    const T along = T(2.0) * look_up(rotation, face) * (sqrt_of(gap2 / n2) + room.at(5, p) + skins);
    const T reach = room.at(4, p) + skins + along, aside = room.at(2, p) + skins + along;
    auto outside = beyond(x[0], x[1], n, n2, v, aside) | beyond(x[1], x[2], n, n2, v, aside);
    outside = outside | beyond(x[2], x[3], n, n2, v, aside) | beyond(x[3], x[0], n, n2, v, aside);
    const Vec3<T> arm = v - T(1.0 / 3.0) * (x[0] + x[1] + x[2]);
    const auto beside = dot(arm, arm) * n2 - gap2 > reach * reach * n2;
    const auto flat = room.at(3, p) < T(0.5);
    set_flags(near, p, !((gap2 > most * most * n2) | beside | (outside & flat)));
  }

 private:
  /// Is a point farther outside the side from a to b than `room`?
  template <class T>
  CDEM_HD static auto beyond(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& n, const T& n2,
                             const Vec3<T>& point, const T& room) {
    const Vec3<T> side = b - a;
    const T out = dot(cross(side, n), point - a);  // times |n| and the length of the side
    return (out > T(0.0)) & (out * out > room * room * n2 * dot(side, side));
  }
};

/// Faces that a vertex of an exposed face may touch before the next rebuild: ragged rows.
struct ListedFaces {
  const Index* first;    // [4 * exposed + 1], slot = 4 * exposed face + vertex
  const Index* pair;     // pair of vertex and face, by ascending face in a row
  const Index* face_of;  // [pair] exposed face
  InBounds room;         // [6][pair] see MarkNearFaces
  const Flag* near;      // [pair] the same
  InBounds motion;       // [pair] the same
  const Real* rotation;  // [exposed] how much its normal may soon rotate  [rad]

  CDEM_HD Index face(Index c) const { return face_of[pair[c]]; }
};

/// Of the faces that are near a vertex, mark those on which a semi-spring may soon go on or begin:
/// the tests of ResolveTargets on its indented point and the two faces, with room.
struct MarkInnerFaces {
  FaceColumns faces;
  FaceGeometry geometry;
  SearchRules rules;
  ListedFaces listed;
  Flag* close;  // [listed] set where selected, 0 before

  CDEM_HD Range items(Index m) const { return {listed.first[4 * m], listed.first[4 * m + 4]}; }
  CDEM_HD bool selects(Index, Index c) const { return listed.near[listed.pair[c]]; }

  template <class I>
  CDEM_HD void operator()(const I& item) const {
    using T = Number<I>;
    const auto t = indices_of([&](Index c) { return listed.face(c); }, item.id);
    const auto node = indices_of(
        [&](Index m, Index c) { return geometry.table[m].corner[vertex_of(listed.first, m, c)]; },
        item.row, item.id);
    const auto c = VertexFace<T>::at(faces, geometry, rules, item.row, node, t);
    const T rotations = look_up(listed.rotation, item.row) + look_up(listed.rotation, t);
    const auto opposes = dot(geometry.normal(item.row), c.normal) < rotations - T(rules.opposing);
    const T motion =
        numbers_of([&](Index x) { return listed.motion.at(0, One{listed.pair[x]}); }, item.id);
    const T zero(0.0), plane = dot(c.normal, c.v - c.center);
    const T above = select(c.target_length > zero, zero, T(-0.5) * c.target_length) + motion;
    const T along = T(2.0) * look_up(listed.rotation, t) * (abs_of(plane) + motion);
    const T room = T(rules.tolerance) * c.length + motion + along;
    auto may = opposes & !(plane > above + T(rules.lifted)) &
               !(plane < T(-rules.depth) * c.length - above);
    if (any_of(may)) may = may & !is_beside(item.id, c, faces.shape(geometry.vertices(t)), room);
    for_lanes(item, [&](Index lane, Index, Index id) { close[id] = holds(may, lane); });
  }

 private:
  /// Is the indented point outside a side at which the surface does not rise?
  template <class T, class Ids>
  CDEM_HD Truth<T> is_beside(const Ids& id, const VertexFace<T>& c, const FaceShape<T>& shape,
                             const T& room) const {
    Truth<T> found = !(c.length > T(0.0));
    for (Index k = 0; k < 4; ++k) {
      const Vec3<T> a = shape.x[k];
      const auto out = outside(a, shape.x[k == 3 ? 0 : k + 1] - a, c.normal, c.p, room);
      if (!any_of(out)) continue;
      const T rises = numbers_of(
          [&](Index x) { return Real(Index(listed.room.at(3, One{listed.pair[x]})) >> k & 1); },
          id);
      found = found | (out & !(rises > T(0.5)));
    }
    return found;
  }
};

/// Count the marked ones, slot by slot.
struct CountInnerFaces {
  const Index* first;
  const Flag* close;
  Index* count;  // [4 * exposed]

  CDEM_HD void operator()(One slot) const {
    Index found = 0;
    for (Index c = first[slot.i]; c < first[slot.i + 1]; ++c) found += close[c];
    count[slot.i] = found;
  }
};

/// List them.
struct ListInnerFaces {
  ListedFaces listed;
  const Flag* close;
  const Index* first;  // [4 * exposed + 1] of the new list
  Index* other;
  Flag* rises;  // may the surface rise at a side of it?

  CDEM_HD void operator()(One slot) const {
    Index place = first[slot.i];
    for (Index c = listed.first[slot.i]; c < listed.first[slot.i + 1]; ++c) {
      if (!close[c]) continue;
      rises[place] = listed.room.at(3, One{listed.pair[c]}) > 0;
      other[place++] = listed.face(c);
    }
  }
};

/// Pairs of edges that may touch before the next rebuild.
struct ListedEdges {
  InIndices of;             // [2][pair]: places in `sides`
  const Index* code;        // [pair]: see EdgeWays
  const Index* sides;       // [edge][2]: 4 * exposed face + side, or -1
  const ExposedRow* table;  // of exposed faces

  /// Nodes of one edge, and of the other, see EdgePairs.
  template <class I>
  CDEM_HD auto end(Index k, I pair) const {
    return indices_of(
        [&](Index p) {
          const Index side = sides[2 * of.at(k / 2, One{p})];
          const ExposedRow& face = table[side / 4];
          return EdgeWays::is_turned(code[p], k / 2) == (k % 2 == 0) ? face.end(side % 4)
                                                                     : face.corner[side % 4];
        },
        pair);
  }
};

/// Mark the pairs of edges that may soon begin to touch. One test stands for the sides of all faces
/// at both edges, in either direction, and has room for the differences between them: indentation
/// and rate of approach.
///
/// Where two edges touch, points of theirs lie on the contact normal, no deeper than a contact may
/// begin. No two points of the edges move relative to each other by more than `motion` until then,
/// so that now they are on the right side of each other but for that, and in the plane across the
/// common perpendicular, which rotates by `swing`, as far apart as that and `swing` times the
/// depth.
struct MarkNearEdges {
  InMotion nodes;
  ListedEdges listed;
  InBounds room;  // [6][pair]: depth at which a contact may begin; how far the indentation moves an
                  // edge aside, at most  [m]; side on which one edge must be of the other, along
                  // the cross product: 1, -1, 0: either; what it takes from the ends of an edge, at
                  // least; distance of the first ends at which edges are together; how far two
                  // points of theirs may soon move relative to each other, without skins  [m]
  const Real* skin;  // [node]  [m]
  SearchRules rules;
  Real dt;  // of the last step  [s]
  Flag* near;

  static constexpr Real round_off = 1e-8;  // of a gap, in parts of the depth

  template <class I>
  CDEM_HD void operator()(I p) const {
    using T = Number<I>;
    const auto a0 = listed.end(0, p), a1 = listed.end(1, p);
    const auto b0 = listed.end(2, p), b1 = listed.end(3, p);
    const Vec3<T> start_a = nodes.position(a0), start_b = nodes.position(b0);
    const Vec3<T> along_a = nodes.position(a1) - start_a, along_b = nodes.position(b1) - start_b;
    const Vec3<T> c = cross(along_a, along_b), apart = start_b - start_a;
    const T c2 = dot(c, c), a2 = dot(along_a, along_a), b2 = dot(along_b, along_b);
    const T gap = dot(c, apart), gap2 = gap * gap;  // times |c|
    const Vec3<T> va = nodes.velocity(a0), vb = nodes.velocity(b0);
    const T rate = size(va - vb) + size(nodes.velocity(a1) - va) + size(nodes.velocity(b1) - vb);
    // between two steps nothing moves farther than twice the motion
    const T motion = room.at(5, p) + max_of(look_up(skin, a0), look_up(skin, a1)) +
                     max_of(look_up(skin, b0), look_up(skin, b1));
    const T approach = T(rules.approach_steps) * max_of(T(dt) * rate, T(2.0) * motion);
    const T depth = room.at(0, p) + approach + motion + T(rules.lifted), shift = room.at(1, p);
    const T behind = motion + T(round_off) * depth + T(rules.lifted);
    const T parted = max_of(room.at(4, p) - motion, T(0.0));
    const auto far = (gap2 > depth * depth * c2) |
                     ((room.at(2, p) * gap < T(0.0)) & (gap2 > behind * behind * c2)) |
                     (dot(apart, apart) < parted * parted);
    if (!any_of(!far)) return set_flags(near, p, !far);
    const T long_a = sqrt_of(a2), long_b = sqrt_of(b2), per_c = T(1.0) / sqrt_of(c2);
    const T sine = T(1.0) / (per_c * long_a * long_b);
    const T rotations = T(2.0) * motion * (T(1.0) / long_a + T(1.0) / long_b);
    const auto parallel = sine + rotations < T(parallel_edges);
    const auto open = !(sine > T(2.0) * rotations);  // may rotate into anything
    // where the lines cross, from the starts of the edges [m]. An indented edge lies beside the
    // true one by `shift` at most, so that the crossing with the target moves by shift / sin of the
    // angle between the two on the target, and by shift * cot on the edge itself.
    const T on_a = dot(cross(apart, along_b), c) * per_c * per_c * long_a;
    const T on_b = dot(cross(apart, along_a), c) * per_c * per_c * long_b;
    const T least = sine - rotations, swing = rotations / least;
    const T off = (motion + swing * depth) / least + T(2.0) * motion;
    const T cot = abs_of(dot(along_a, along_b)) * per_c + swing / least;
    const T inset = room.at(3, p) - shift * cot - off, beside = -shift / least - off;
    const auto crosses = (within(on_a, inset, long_a) & within(on_b, beside, long_b)) |
                         (within(on_b, inset, long_b) & within(on_a, beside, long_a));
    set_flags(near, p, (open | crosses) & !(far | parallel));
  }

 private:
  /// Not less than the length of a vector.
  template <class T>
  CDEM_HD static T size(const Vec3<T>& v) {
    return abs_of(v.x) + abs_of(v.y) + abs_of(v.z);
  }
  /// Does a place on an edge lie at least `from_ends` from both ends?
  template <class T>
  CDEM_HD static auto within(const T& place, const T& from_ends, const T& length) {
    return !((place < from_ends) | (place > length - from_ends));
  }
};

/// Pairs of edges of the outer list, and the edges of the mesh that they are of.
struct EdgesOfPairs {
  InIndices of;        // see ListedEdges
  const Index* sides;  // the same
  const Index* edges;  // [edge] of the mesh

  CDEM_HD Index edge(Index pair, Index which) const { return edges[of.at(which, One{pair})]; }
  /// Do faces of one element alone meet at the edge?
  CDEM_HD bool is_of_one(Index pair, Index which) const {
    return sides[2 * of.at(which, One{pair}) + 1] >= 0;
  }
};

/// The row of a pair in PairsOfEdges, see list_rows.
struct RowOfEdges {
  EdgesOfPairs edges;

  template <class Act>
  CDEM_HD void visit(One pair, const Act& act) const {
    const Index a = edges.edge(pair.i, 0), b = edges.edge(pair.i, 1);
    act(a < b ? a : b, pair.i);
  }
};

/// Pairs of edges by the edge of the lower number: ragged rows.
struct PairsOfEdges {
  const Index* first;   // [edge + 1]
  const Index* listed;  // pair
  EdgesOfPairs edges;

  /// Visit the pairs of two edges.
  template <class Visit>
  CDEM_HD void each(Index a, Index b, const Visit& visit) const {
    const Index low = a < b ? a : b, high = a < b ? b : a;
    for (Index i = first[low]; i < first[low + 1]; ++i) {
      const Index one = edges.edge(listed[i], 0);
      if ((one == low ? edges.edge(listed[i], 1) : one) == high) visit(listed[i]);
    }
  }
};

/// Those that are in contact must be looked at all the same: whatever faces the pair is listed for,
/// as another face at the target edge may be the right one soon.
struct MarkHeldEdges {
  const Index* exposed_face;
  const Index* face_edges;  // see FaceColumns
  const Index* contact;     // rows of EdgeContact
  PairsOfEdges pairs;
  Flag* near;

  CDEM_HD void operator()(One c) const {
    const EdgeContact held = EdgeContact::at(contact, c.i);
    const Index edge = face_edges[4 * exposed_face[held.mother / 4] + held.mother % 4];
    pairs.each(edge, held.edge, [&](Index pair) { set(near[pair]); });
  }
};

/// Where faces of two elements meet at an edge, a contact may be found through another pair than
/// the one that is near: all pairs of the same two edges are listed together.
struct JoinPairsOfEdges {
  const Flag* near;
  PairsOfEdges pairs;
  Flag* joined;  // initially those that are near

  CDEM_HD void operator()(One p) const {
    const EdgesOfPairs& edges = pairs.edges;
    if (!near[p.i] || (edges.is_of_one(p.i, 0) && edges.is_of_one(p.i, 1))) return;
    pairs.each(edges.edge(p.i, 0), edges.edge(p.i, 1), [&](Index pair) { set(joined[pair]); });
  }
};

/// Copy the pairs of edges that are near to where the search looks for them.
struct CopyInnerEdges {
  const Index* near;  // [pair]
  ListedEdges listed;
  const Index* edge_of;                 // [edge] of the mesh
  Index *ends, *sides, *codes, *edges;  // of EdgePairs
  Index stride;

  CDEM_HD void operator()(One pair) const {
    const One from{near[pair.i]};
    for (Index k = 0; k < 4; ++k) ends[place(k, pair)] = listed.end(k, from);
    Index code = listed.code[from.i];
    for (Index e = 0; e < 2; ++e) {
      const Index* of_edge = listed.sides + 2 * listed.of.at(e, from);
      sides[place(2 * e, pair)] = of_edge[0];
      if (of_edge[1] >= 0 && beside(of_edge[0]) == of_edge[1] / 4 &&
          beside(of_edge[1]) == of_edge[0] / 4)
        code = EdgeWays::with_neighbours(code, e);
      else if (beside(of_edge[0]) >= 0 || of_edge[1] >= 0)
        code = EdgeWays::with_others(code);
      edges[place(e, pair)] = edge_of[listed.of.at(e, from)];
      sides[place(2 * e + 1, pair)] = of_edge[1] >= 0 ? of_edge[1] : of_edge[0];
    }
    codes[pair.i] = code;
  }

 private:
  CDEM_HD Index beside(Index side) const { return listed.table[side / 4].beside[side % 4]; }
  CDEM_HD std::size_t place(Index row, One pair) const {
    return std::size_t(row) * stride + pair.i;
  }
};

}  // namespace cdem
