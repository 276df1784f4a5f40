// Two edges: where they cross, their normal and their frame.
#include "core/contact/geometry/edge.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

namespace {

struct TwoEdges {
  Vec start_m, along_m, start_t, along_t;
};

/// Edges that cross at s and t of their length, the mother's above the target's by `gap` along
/// `out`, which is a common perpendicular.
TwoEdges crossing_edges(Random& random, Real s, Real t, Real gap, Vec& out) {
  const Mat r = random.rotation();
  const Real angle = random.between(0.3, 2.8);
  TwoEdges e;
  e.along_m = random.between(0.5, 2) * r.r0;
  e.along_t =
      random.between(0.5, 2) * (Real(std::cos(angle)) * r.r0 + Real(std::sin(angle)) * r.r1);
  out = random.below(2) ? r.r2 : -r.r2;
  const Vec at = random.vector(3);
  e.start_t = at - t * e.along_t;
  e.start_m = at + gap * out - s * e.along_m;
  return e;
}

}  // namespace

TEST_CASE("edges cross where they were made to, with the gap between them") {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Real s = random.between(0, 1), t = random.between(0, 1), gap = random.between(-0.1, 0.1);
    Vec out;
    const TwoEdges e = crossing_edges(random, s, t, gap, out);
    const Vec n = edge_normal(e.along_m, e.along_t, out);
    CHECK(distance(n, out) < 3e-15);
    const Crossing<Real> c = cross_edges(e.start_m, e.along_m, e.start_t, e.along_t, n);
    CHECK(std::abs(c.s - s) < 1e-14);
    CHECK(std::abs(c.t - t) < 5e-15);
    CHECK(std::abs(c.gap - gap) < 2e-15);
  }
}

TEST_CASE("seen along any direction, the points of a crossing lie on one line along it") {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    Vec out;
    const TwoEdges e = crossing_edges(random, 0.4, 0.7, random.between(-0.1, 0.1), out);
    const Vec way = out + random.vector(0.3);
    const Crossing<Real> c = cross_edges(e.start_m, e.along_m, e.start_t, e.along_t, way);
    const Vec apart = (e.start_m + c.s * e.along_m) - (e.start_t + c.t * e.along_t);
    CHECK(distance(apart, c.gap * way) < 3e-15);
  }
}

TEST_CASE("the rate of the gap is that of the two points along the normal") {
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    Vec out;
    const TwoEdges e = crossing_edges(random, 0.3, 0.6, 0.05, out);
    const Vec v = random.vector(1), turn = random.vector(1);
    const auto gap_after = [&](Real time) {
      const Vec start = e.start_m + time * v, along = e.along_m + time * turn;
      const Vec n = edge_normal(along, e.along_t, out);
      return cross_edges(start, along, e.start_t, e.along_t, n).gap;
    };
    const Vec n = edge_normal(e.along_m, e.along_t, out);
    const Crossing<Real> c = cross_edges(e.start_m, e.along_m, e.start_t, e.along_t, n);
    constexpr Real dt = 1e-5;
    const Real rate = (gap_after(dt) - gap_after(-dt)) / (2 * dt);
    CHECK(std::abs(rate - dot(n, v + c.s * turn)) < 1e-9);
  }
}

TEST_CASE("the frame of an edge pair is orthonormal, its first tangent along the target") {
  Random random(4);
  for (int k = 0; k < 100; ++k) {
    Vec out;
    const TwoEdges e = crossing_edges(random, 0.5, 0.5, 0, out);
    const Frame<Real> f = edge_frame(edge_normal(e.along_m, e.along_t, out), e.along_t);
    CHECK(distance(Mat{f.n, f.t1, f.t2} * transpose(Mat{f.n, f.t1, f.t2}), identity<Real>()) <
          3e-15);
    CHECK(distance(f.t1, unit(e.along_t)) < 1e-15);
  }
}

TEST_CASE("edges of packs are those of their numbers") {
  Random random(5);
  check_lanes<15, 9>(
      [](const auto* in, auto* out) {
        const auto n = edge_normal(vector_at(in + 3), vector_at(in + 9), vector_at(in + 12));
        const auto c =
            cross_edges(vector_at(in), vector_at(in + 3), vector_at(in + 6), vector_at(in + 9), n);
        out[0] = c.s, out[1] = c.t, out[2] = c.gap;
        put(out + 3, n);
        put(out + 6, edge_frame(n, vector_at(in + 9)).t2);
      },
      [&](Real* in) {
        for (Index k = 0; k < 15; k += 3) put(in + k, random.vector(2));
      });
}

}  // namespace cdem::test
