// deep_overlaps.cpp - see deep_overlaps.hpp.
#include "core/contact/pair_list/deep_overlaps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/openmp.hpp"
#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/bounding_boxes.hpp"
#include "core/contact/narrow_phase/side_pairs.hpp"
#include "core/contact/narrow_phase/views.hpp"
#include "core/model/force_sets.hpp"

namespace cdem {

namespace {

/// Faces of an element by its number of nodes, outward; a triangle names its last node twice.
using FaceTable = std::vector<std::array<Index, 4>>;
const FaceTable& faces_of_shape(Index nodes) {
  static const FaceTable tet = {{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 3, 2, 2}};
  static const FaceTable pyramid = {
      {0, 3, 2, 1}, {0, 1, 4, 4}, {1, 2, 4, 4}, {2, 3, 4, 4}, {3, 0, 4, 4}};
  static const FaceTable wedge = {
      {0, 2, 1, 1}, {3, 4, 5, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static const FaceTable hexahedron = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return nodes == 4 ? tet : nodes == 5 ? pyramid : nodes == 6 ? wedge : hexahedron;
}

/// Extent of an element along a direction.
struct Extent {
  Real low = 1e300, high = -1e300;
  void include(Real x) { low = std::min(low, x), high = std::max(high, x); }
};
/// How far one must be moved along the direction until they are apart; negative where they are.
Real overlap_of(const Extent& a, const Extent& b) {
  return std::min(a.high - b.low, b.high - a.low);
}

/// An element as a convex body.
struct Body {
  Index element, count;
  Index node[8];
  Vec3<Real> x[8];
  const FaceTable* faces;
  Vec3<Real> normal[6], center[6];

  void find_normals() {
    for (std::size_t f = 0; f < faces->size(); ++f) {
      const auto& k = (*faces)[f];
      const bool quad = k[2] != k[3];
      normal[f] = unit(cross(x[k[2]] - x[k[0]], x[k[3]] - x[k[1]]));
      const Vec3<Real> three = x[k[0]] + x[k[1]] + x[k[2]];
      center[f] = quad ? Real(0.25) * (three + x[k[3]]) : Real(1.0 / 3) * three;
    }
  }
  Extent along(const Vec3<Real>& n) const {
    Extent e;
    for (Index k = 0; k < count; ++k) e.include(dot(n, x[k]));
    return e;
  }
  /// Depth of a point behind the nearest face; negative outside.
  Real depth_of(const Vec3<Real>& point) const {
    Real depth = 1e300;
    for (std::size_t f = 0; f < faces->size(); ++f)
      depth = std::min(depth, dot(normal[f], center[f] - point));
    return depth;
  }
  /// Directions of its edges, parallel ones once.
  std::vector<Vec3<Real>> edge_directions() const {
    constexpr Real parallel = 1e-12;
    std::vector<Vec3<Real>> found;
    for (const auto& face : *faces)
      for (Index k = 0; k < 4; ++k) {
        const Vec3<Real> side = x[face[(k + 1) % 4]] - x[face[k]];
        const Real length = norm(side);
        if (!(length > 0)) continue;
        const Vec3<Real> direction = Real(1) / length * side;
        if (std::none_of(found.begin(), found.end(), [&](const Vec3<Real>& other) {
              const Vec3<Real> across = cross(direction, other);
              return dot(across, across) < parallel;
            }))
          found.push_back(direction);
      }
    return found;
  }
};

using NodesOf = decltype(nodes_of(std::declval<Model&>(), std::declval<ElementSet&>()));

/// Looks for overlaps of elements.
class Overlaps {
 public:
  Overlaps(const Model& model, State& state)
      : m(model),
        s(state),
        edges(on_host(touching_edges(m, s))),
        nodes_(on_host(InMotion{s.nodes.motion.data()})),
        exposed_face_(on_host(s.search.exposed_face)),
        target_(on_host(s.springs.target)),
        springs_(on_host(s.springs.state)) {
    for_each_element_set(m, s, [&](auto, const ElementSet& e, const ElementState&) {
      sets_.push_back(nodes_of(m, e));
      first_.push_back(element_count_);
      element_count_ += e.count;
    });
    list_elements();
    list_faces();
    list_contacts();
  }

  DeepOverlaps find(InitialOverlaps& adopted) {
    std::vector<Found> found = search_all();
    if (found.empty()) return {};
    adopt_inside(found, adopted);
    list_contacts();
    std::erase_if(found,
                  [&](const Found& f) { return is_held(body(f.a), body(f.b), f.depth, f.limit); });
    return summary(found);
  }

 private:
  struct Found {
    Index a, b;
    Real depth, limit;
    /// The deepest first, and of equal ones the first.
    bool is_worse(const Found& other) const {
      if (depth != other.depth) return depth > other.depth;
      return std::pair(a, b) < std::pair(other.a, other.b);
    }
  };
  struct Held {
    Index node, block;
    Real depth;
    auto key() const { return std::pair(node, block); }
  };

  /// Pairs of elements that are not held.
  std::vector<Found> search_all() const {
    Column<Box> boxes;
    boxes.assign(boxes_);
    BoxTreeColumns columns;
    columns.make({}, boxes);
    const BoxTree tree = on_host(columns.tree());
    std::vector<std::vector<Found>> by_thread(omp_get_max_threads());
#pragma omp parallel if (element_count_ >= worth_threads)
    {
      std::vector<Found>& found = by_thread[omp_get_thread_num()];
#pragma omp for schedule(dynamic, 64)
      for (Index a = 0; a < element_count_; ++a)
        if (movable(a)) search_around(a, tree, found);
    }
    std::vector<Found> all;
    for (const auto& some : by_thread) all.insert(all.end(), some.begin(), some.end());
    return all;
  }
  /// Adopt vertices that lie deep inside an element, where a step would hold them: beside a rim an
  /// edge may reach deeper, in free air.
  void adopt_inside(const std::vector<Found>& found, InitialOverlaps& adopted) {
    std::vector<Flag> inside(m.node_count, 0);
    for (const Found& f : found) {
      const Body a = body(f.a), b = body(f.b);
      for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (Index k = 0; k < one->count; ++k)
          if (other->depth_of(one->x[k]) > f.limit) inside[one->node[k]] = 1;
    }
    const ResolveTargets search = on_host(ResolveTargets{face_search(m, s)});
    for (Index x = 0; x < Index(exposed_face_.size()); ++x)
      for (Index k = 0; k < search.faces.vertex_count(exposed_face_[x]); ++k)
        if (inside[search.faces.vertex(exposed_face_[x], k)] && target_[4 * x + k] < 0)
          adopt_vertex(search, x, k, adopted);
  }

  Body body(Index element) const {
    Body b = corners(element);
    b.find_normals();
    return b;
  }
  /// A body without normals.
  Body corners(Index element) const {
    std::size_t set = 0;
    while (set + 1 < sets_.size() && element >= first_[set + 1]) ++set;
    Body b;
    b.element = element, b.count = 0;
    sets_[set](element - first_[set], [&](Index node) {
      b.node[b.count] = node;
      b.x[b.count++] = nodes_.position(node);
    });
    b.faces = &faces_of_shape(b.count);
    return b;
  }
  void list_elements() {
    boxes_.resize(element_count_, Box::nothing());
    block_.resize(element_count_);
    entry_.resize(element_count_);
    warpage_.resize(element_count_);
    const auto node_block = on_host(m.node_block);
#pragma omp parallel for schedule(static) if (element_count_ >= worth_threads)
    for (Index e = 0; e < element_count_; ++e) {
      const Body b = body(e);
      block_[e] = node_block[b.node[0]];
      for (Index k = 0; k < b.count; ++k) boxes_[e].include(b.x[k]);
      Real length = 1e300, warpage = 0;
      for (std::size_t f = 0; f < b.faces->size(); ++f) {
        const auto& face = (*b.faces)[f];
        const Index corners = face[2] == face[3] ? 3 : 4;
        Real mean = 0;
        for (Index k = 0; k < corners; ++k) {
          const Vec3<Real> arm = b.x[face[k]] - b.center[f];
          mean += norm(arm) / corners;
          warpage = std::max(warpage, std::abs(dot(b.normal[f], arm)));
        }
        length = std::min(length, mean);
      }
      entry_[e] = m.rules.entry * length;
      warpage_[e] = warpage;
    }
  }
  void list_faces() {
    movable_.assign(*std::max_element(block_.begin(), block_.end()) + 1, 0);
    surface_.assign(m.node_count, 0);
    element_faces_.reserve(exposed_face_.size());
    const auto block = on_host(m.face_block), element = on_host(m.face_element);
    const auto face_movable = on_host(m.face_movable);
    for (Index f = 0; f < m.face_count; ++f)
      if (face_movable[f]) movable_[block[f]] = 1;
    for (Index x = 0; x < Index(exposed_face_.size()); ++x) {
      const Index face = exposed_face_[x];
      element_faces_.push_back({element[face], x});
      for (Index k = 0; k < edges.faces.vertex_count(face); ++k)
        surface_[edges.faces.vertex(face, k)] = 1;
    }
    std::sort(element_faces_.begin(), element_faces_.end());
  }
  /// Contacts of vertices and how deep they hold.
  void list_contacts() {
    const auto face_block = on_host(m.face_block);
    held_.clear();
    for (std::size_t x = 0; x < exposed_face_.size(); ++x)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t slot = 4 * x + k;
        if (target_[slot] < 0) continue;
        const Real free = ContactState::at(springs_.data(), slot).stress_free_gap;
        held_.push_back({edges.faces.vertex(exposed_face_[x], Index(k)),
                         face_block[exposed_face_[target_[slot]]], -free});
      }
    std::sort(held_.begin(), held_.end(), [](const Held& a, const Held& b) {
      return std::pair(a.key(), a.depth) < std::pair(b.key(), b.depth);
    });
  }

  bool movable(Index element) const { return movable_[block_[element]] != 0; }
  /// Contacts begin by themselves down to here.
  Real limit_of(Index a, Index b) const {
    return std::min(entry_[a], entry_[b]) + warpage_[a] + warpage_[b];
  }
  void search_around(Index a, const BoxTree& tree, std::vector<Found>& found) const {
    Body of_a;
    of_a.count = 0;  // until there is a neighbour
    std::vector<Vec3<Real>> directions;
    tree.query(boxes_[a], [&](Index b) {
      if (block_[a] == block_[b] || (b < a && movable(b))) return;
      const Real limit = limit_of(a, b);
      for (int d = 0; d < 3; ++d)
        if (std::min(boxes_[a].high[d] - boxes_[b].low[d], boxes_[b].high[d] - boxes_[a].low[d]) <=
            limit)
          return;
      if (of_a.count == 0) of_a = body(a);
      Body of_b = corners(b);
      const Real depth = overlap(of_a, of_b, directions, limit);
      if (depth > limit && !is_held(of_a, of_b, depth, limit))
        found.push_back({a, b, depth, limit});
    });
  }
  /// Separating axes of two convex bodies: the shortest displacement that separates them, or
  /// anything up to
  /// `limit` as soon as it is no more. Most bodies are apart along a normal of the first, so those
  /// of the second and directions of edges are found where they are needed.
  static Real overlap(const Body& a, Body& b, std::vector<Vec3<Real>>& directions_of_a,
                      Real limit) {
    Real least = 1e300;
    const auto try_along = [&](const Vec3<Real>& n) {
      least = std::min(least, overlap_of(a.along(n), b.along(n)));
      return least > limit;
    };
    const auto try_faces = [&](const Body& of) {
      for (std::size_t f = 0; f < of.faces->size(); ++f)
        if (!try_along(of.normal[f])) return false;
      return true;
    };
    if (!try_faces(a)) return least;
    b.find_normals();
    if (!try_faces(b)) return least;
    if (directions_of_a.empty()) directions_of_a = a.edge_directions();
    for (const Vec3<Real>& v : b.edge_directions())
      for (const Vec3<Real>& u : directions_of_a) {
        const Vec3<Real> n = cross(u, v);
        const Real sine = norm(n);
        if (sine > 1e-6 && !try_along(Real(1) / sine * n)) return least;
      }
    return least;
  }

  /// Depth at which a node is held against a block; negative where it is not.
  Real held_depth(Index node, Index block) const {
    const auto after =
        std::upper_bound(held_.begin(), held_.end(), std::pair(node, block),
                         [](const auto& key, const Held& held) { return key < held.key(); });
    if (after == held_.begin() || (after - 1)->key() != std::pair(node, block)) return -1;
    return (after - 1)->depth;
  }
  /// A vertex deep inside the other needs a contact. Else it is enough that one vertex of either
  /// has one, or edges that cross no deeper than they may begin. A contact holds at least as deep
  /// as the elements overlap; half of that tells it from contacts elsewhere on the same element.
  bool is_held(const Body& a, const Body& b, Real depth, Real limit) const {
    bool held = false;
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
      for (Index k = 0; k < one->count; ++k) {
        const Real holds = held_depth(one->node[k], block_[other->element]);
        if (holds < 0 && surface_[one->node[k]] && other->depth_of(one->x[k]) > limit) return false;
        held = held || holds > 0.5 * depth;
      }
    return held || edges_hold(a.element, b.element, depth) ||
           edges_hold(b.element, a.element, depth);
  }
  bool edges_hold(Index a, Index b, Real depth) const {
    if (!m.semi_edges) return false;
    const auto faces_of = [&](Index element) {
      return std::pair(std::lower_bound(element_faces_.begin(), element_faces_.end(),
                                        std::pair(element, Index(0))),
                       std::lower_bound(element_faces_.begin(), element_faces_.end(),
                                        std::pair(element + 1, Index(0))));
    };
    const auto [a_first, a_last] = faces_of(a);
    const auto [b_first, b_last] = faces_of(b);
    for (auto x = a_first; x != a_last; ++x)
      for (auto t = b_first; t != b_last; ++t) {
        const Real begins = m.rules.entry * std::min(edges.geometry.length(x->second),
                                                     edges.geometry.length(t->second));
        if (depth <= begins + warpage_[a] + warpage_[b] && sides_touch(x->second, t->second))
          return true;
      }
    return false;
  }
  bool sides_touch(Index x, Index t) const {
    const Index mother = exposed_face_[x], target = exposed_face_[t];
    for (Index k = 0; k < edges.faces.vertex_count(mother); ++k)
      for (Index j = 0; j < edges.faces.vertex_count(target); ++j) {
        Index shared;
        if (pair_sides(edges.faces, mother, k, target, j, shared) &&
            edges.touch(4 * x + k, 4 * t + j, shared, -1))
          return true;
      }
    return false;
  }

  DeepOverlaps summary(const std::vector<Found>& found) const {
    DeepOverlaps all;
    if (found.empty()) return all;
    all.count = Index(found.size());
    const auto worst = std::min_element(
        found.begin(), found.end(), [](const Found& a, const Found& b) { return a.is_worse(b); });
    all.block[0] = block_[worst->a], all.block[1] = block_[worst->b];
    all.depth = worst->depth;
    all.allowed = worst->limit;
    const Box &a = boxes_[worst->a], &b = boxes_[worst->b];
    const auto middle = [&](int d) {
      return 0.5 * (std::max(a.low[d], b.low[d]) + std::min(a.high[d], b.high[d]));
    };
    all.place = {middle(0), middle(1), middle(2)};
    return all;
  }

  const Model& m;
  State& s;
  const TouchingEdges edges;
  const InMotion nodes_;
  const OnHost<Index> exposed_face_, target_;
  const OnHost<Real> springs_;
  std::vector<NodesOf> sets_;
  std::vector<Index> first_;  // [set] number of its first element among all
  Index element_count_ = 0;
  std::vector<Box> boxes_;                              // [element]
  std::vector<Index> block_;                            // [element]
  std::vector<Real> entry_, warpage_;                   // [element]
  std::vector<Flag> movable_, surface_;                 // [block], [node]
  std::vector<std::pair<Index, Index>> element_faces_;  // element and exposed face, sorted
  std::vector<Held> held_;                              // sorted
};

}  // namespace

DeepOverlaps find_deep_overlaps(const Model& m, State& s, InitialOverlaps& adopted) {
  return Overlaps(m, s).find(adopted);
}

}  // namespace cdem
