// pair_search.cpp - see pair_search.hpp.
#include "core/contact/broad_phase/pair_search.hpp"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "core/base/openmp.hpp"
#include "core/base/parallel.hpp"
#include "core/contact/broad_phase/edge_edge_pairs.hpp"
#include "core/contact/broad_phase/separating_planes.hpp"
#include "core/contact/broad_phase/vertex_face_pairs.hpp"
#include "core/contact/geometry/views.hpp"

namespace cdem {

namespace {

/// Does a plane along a face of either patch hold the two apart until the next rebuild?
bool apart(const PairContext& f, const Patch& a, const Patch& b) {
  const InMotion& nodes = f.faces.nodes;
  const Real room = farthest_contact(f.m.rules, a, b);
  const Vec3<Real> closing = last_step * (b.displacement - a.displacement);
  const auto range = [&](const Patch& p, const Vec3<Real>& n, const Vec3<Real>& c) {
    std::pair<Real, Real> r{1e300, -1e300};
    for (Index i = 0; i < p.vertex_count; ++i) {
      const Real up = dot(n, nodes.position(p.vertex[i]) - c);
      r = {std::min(r.first, up), std::max(r.second, up)};
    }
    return r;
  };
  for (const Patch* p : {&a, &b})
    for (Index i = 0; i < p->face_count; ++i) {
      const ExposedFace& face = f.exposed[p->face[i]];
      const auto of_a = range(a, face.normal, face.center);
      const auto of_b = range(b, face.normal, face.center);
      const Real closer = dot(face.normal, closing);
      if (of_b.first - of_a.second + std::min(closer, 0.0) > room ||
          of_a.first - of_b.second - std::max(closer, 0.0) > room)
        return true;
    }
  return false;
}

/// List the sides at the edges of all patches, see EdgePairs; patches get their places.
void list_edge_sides(Unset<Patch>& patches, Unset<Index>& sides) {
  Index count = 0;
  for (Patch& patch : patches) {
    patch.edge_first = count;
    count += patch.edge_count;
  }
  sides.resize(2 * std::size_t(count));
  const Index patch_count = Index(patches.size());
#pragma omp parallel for schedule(static, 128) if (patch_count >= worth_threads)
  for (Index p = 0; p < patch_count; ++p)
    for (Index e = 0; e < patches[p].edge_count; ++e) {
      const Patch::Edge& edge = patches[p].edge[e];
      for (Index i = 0; i < 2; ++i)
        sides[2 * std::size_t(patches[p].edge_first + e) + i] =
            i < edge.faces ? 4 * patches[p].face[edge.face[i]] + edge.side[i] : -1;
    }
}

/// Possible contacts of two patches before the next rebuild.
void list_pairs(const PairContext& f, const Patch& a, const Patch& b, PairBuffer& found) {
  const SeparatedParts separated(f, a, b);
  const FacePairMask pairs(f, a, b, separated);
  if (!pairs.any()) return;
  ListedFacePairs listed;
  list_vertex_face_pairs(f, a, b, pairs, separated, false, listed, found);
  list_vertex_face_pairs(f, b, a, pairs, separated, true, listed, found);
  if (f.m.semi_edges) list_edges(f, a, b, pairs, separated, listed, found);
  if (f.m.interface_traits.ask_area) listed.add(pairs);
  listed.list(a, b, found);
}

}  // namespace

void search_pairs(const Model& m, const State& s, PairSearch& search) {
  Unset<ExposedFace>& exposed = search.exposed;
  Unset<ExposedSide>& sides = search.sides;
  Unset<Patch>& patches = search.patches;
  list_exposed_faces(m, s, exposed);
  list_exposed_sides(s, exposed, sides);
  list_patches(m, s, exposed, patches);
  const Bonded bonded = live_overlaps(m, s);
  const PairContext f{.m = m, .s = s, .exposed = exposed, .sides = sides, .bonded = bonded};
  const Index count = Index(patches.size());
  std::vector<Box> boxes(count);
  for (Index p = 0; p < count; ++p) boxes[p] = patches[p].box;
  const BoxTree tree(boxes);
  PairBuffers& all = search.found;
  all.by_thread.resize(omp_get_max_threads());
  all.by_patch.assign(count, {});
  list_edge_sides(patches, all.edge_sides);
  std::exception_ptr failure;  // memory may run out, and no exception may leave a parallel loop
#pragma omp parallel if (count >= worth_threads)
  {
    const Index thread = omp_get_thread_num();
    PairBuffer& found = all.by_thread[thread];
    std::vector<Index> others;
#pragma omp for schedule(dynamic, 32)
    for (Index p = 0; p < count; ++p) try {
        if (!patches[p].movable) continue;  // movable patches find it
        others.clear();
        tree.query(boxes[p], [&](Index q) {
          if ((q > p || !patches[q].movable) && patches[p].block != patches[q].block &&
              !apart(f, patches[p], patches[q]))
            others.push_back(q);
        });
        std::sort(others.begin(), others.end());
        all.by_patch[p].begin(thread, found);
        for (const Index q : others) list_pairs(f, patches[p], patches[q], found);
        all.by_patch[p].end(found);
      } catch (...) {
#pragma omp critical
        failure = std::current_exception();
      }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace cdem
