// separating_planes.cpp - see separating_planes.hpp.
#include "core/contact/broad_phase/separating_planes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cdem {

namespace {

/// Of the vertices of a patch along a normal  [m].
struct Heights {
  Real at[8], least = 1e300, most = -1e300;
  Heights(const PairContext& f, const Patch& p, const Vec3<Real>& n, const Vec3<Real>& origin) {
    for (Index v = 0; v < p.vertex_count; ++v) {
      at[v] = dot(n, f.faces.nodes.position(p.vertex[v]) - origin);
      least = std::min(least, at[v]);
      most = std::max(most, at[v]);
    }
  }
};

/// All vertices of x stay above the plane of y until the next rebuild: they cannot touch.
bool apart(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  Real lowest = 1e300, span2 = 0;
  for (Index k = 0; k < x.shape.count(); ++k) {
    const Vec3<Real> arm = x.shape.x[k] - y.center;
    lowest = std::min(lowest, dot(y.normal, arm));
    span2 = std::max(span2, dot(arm, arm));
  }
  if (lowest < 0) return false;
  const Real turned = y.rotation * (std::sqrt(span2) + motion_between(x, y));
  return lowest + GapChange(x, y, y.normal).least > turned + y.warpage + rules.lifted;
}

/// May anything of the two faces touch before the next rebuild?
bool may_touch(const SearchRules& rules, const ExposedFace& x, const ExposedFace& y) {
  return x.block != y.block && (x.movable || y.movable) &&
         dot(x.normal, y.normal) < -rules.opposing + x.rotation + y.rotation &&
         !apart(rules, x, y) && !apart(rules, y, x);
}

}  // namespace

SeparatedParts::SeparatedParts(const PairContext& f, const Patch& a, const Patch& b) {
  const Real room = farthest_crossing(f.m.rules, a, b);
  const Vec3<Real> closing = last_step * (b.displacement - a.displacement);
  unsigned bit = 1;
  for (const Patch* p : {&a, &b})
    for (Index i = 0; i < p->face_count; ++i, bit <<= 2) {
      const Vec3<Real>& n = f.exposed[p->face[i]].normal;
      const Vec3<Real>& origin = f.exposed[p->face[i]].center;
      const Heights of_a(f, a, n, origin), of_b(f, b, n, origin);
      const Real closer = dot(n, closing);
      const Real up = room + std::max(closer, 0.0), down = room - std::min(closer, 0.0);
      for (Index v = 0; v < a.vertex_count; ++v)
        vertex[0][v] |= (of_a.at[v] - of_b.most > up ? bit : 0) |
                        (of_b.least - of_a.at[v] > down ? bit << 1 : 0);
      for (Index v = 0; v < b.vertex_count; ++v)
        vertex[1][v] |= (of_b.at[v] - of_a.most > down ? bit : 0) |
                        (of_a.least - of_b.at[v] > up ? bit << 1 : 0);
    }
  spread(a, 0, b.whole);
  spread(b, 1, a.whole);
}

void SeparatedParts::spread(const Patch& p, int of, bool other_is_whole) {
  for (Index e = 0; e < p.edge_count; ++e)
    edge[of][e] = vertex[of][p.edge[e].vertex[0]] & vertex[of][p.edge[e].vertex[1]];
  for (Index v = 0; v < p.vertex_count && !other_is_whole; ++v) vertex[of][v] = 0;
  for (Index i = 0; i < p.face_count; ++i) {
    unsigned all = ~0u;
    no_vertex_on[of][i] = true;
    for (Index v = 0; v < p.vertex_count; ++v) {
      if (p.corner[v][i] < 0) continue;
      all &= vertex[of][v];
      no_vertex_on[of][i] = no_vertex_on[of][i] && vertex[of][v];
    }
    nothing_on[of][i] = all;
  }
}

FacePairMask::FacePairMask(const PairContext& f, const Patch& a, const Patch& b,
                           const SeparatedParts& separated) {
  for (Index i = 0; i < a.face_count; ++i)
    for (Index j = 0; j < b.face_count; ++j)
      if (!separated.hold_apart(i, j) &&
          may_touch(f.m.rules, f.exposed[a.face[i]], f.exposed[b.face[j]]) &&
          !Bonded::among(f.bonded.faces, a.face[i], b.face[j]))
        row[i] |= 1 << j;
}

void ListedFacePairs::add(const FacePairMask& pairs) {
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      if (pairs.row[i] >> j & 1) add(false, i, j), add(true, j, i);
}

void ListedFacePairs::list(const Patch& a, const Patch& b, PairBuffer& found) const {
  for (Index i = 0; i < a.face_count; ++i)
    for (Index j = 0; j < b.face_count; ++j) {
      if (row[0][i] >> j & 1) found.face_pairs.push_back({a.face[i], b.face[j]});
      if (row[1][j] >> i & 1) found.face_pairs.push_back({b.face[j], a.face[i]});
    }
}

}  // namespace cdem
