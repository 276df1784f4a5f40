// reference.hpp - elements of any shape in memory, as the model keeps them.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/base/column.hpp"
#include "core/elements/tiles.hpp"
#include "tests/core/support.hpp"

namespace cdem::test {

/// A Gauss point of the reference element.
struct GaussPoint {
  Vec at;
  Real weight;
};

/// Corners, Gauss points and slopes of the shape functions of a reference element.
template <class Shape>
struct Reference;

template <>
struct Reference<Tet4> {
  static std::array<Vec, 4> corners() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; }
  static std::array<GaussPoint, 1> points() { return {{{{0.25, 0.25, 0.25}, 1.0 / 6}}}; }
  static std::array<Vec, 4> slopes(const Vec&) {
    return {{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  }
};

template <>
struct Reference<Hex8> {
  static std::array<Vec, 8> corners() {
    return {{{-1, -1, -1},
             {1, -1, -1},
             {1, 1, -1},
             {-1, 1, -1},
             {-1, -1, 1},
             {1, -1, 1},
             {1, 1, 1},
             {-1, 1, 1}}};
  }
  static std::array<GaussPoint, 8> points() {
    std::array<GaussPoint, 8> all;
    for (Index k = 0; k < 8; ++k) all[k] = {Real(1 / std::sqrt(3.0)) * corners()[k], 1};
    return all;
  }
  static std::array<Vec, 8> slopes(const Vec& p) {
    std::array<Vec, 8> all;
    for (Index k = 0; k < 8; ++k) {
      const Vec c = corners()[k], f{1 + p.x * c.x, 1 + p.y * c.y, 1 + p.z * c.z};
      all[k] = Real(0.125) * Vec{c.x * f.y * f.z, c.y * f.z * f.x, c.z * f.x * f.y};
    }
    return all;
  }
};

template <>
struct Reference<Wedge6> {
  static std::array<Vec, 6> corners() {
    return {{{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  }
  static std::array<GaussPoint, 6> points() {
    std::array<GaussPoint, 6> all;
    for (Index k = 0; k < 6; ++k) {
      const Vec c = corners()[k];
      all[k] = {{1.0 / 6 + 0.5 * c.x, 1.0 / 6 + 0.5 * c.y, c.z / std::sqrt(3.0)}, 1.0 / 6};
    }
    return all;
  }
  static std::array<Vec, 6> slopes(const Vec& p) {
    const Real part[3] = {1 - p.x - p.y, p.x, p.y};
    const Vec along[3] = {{-1, -1, 0}, {1, 0, 0}, {0, 1, 0}};
    std::array<Vec, 6> all;
    for (Index k = 0; k < 6; ++k) {
      const Real end = k < 3 ? -1 : 1;
      all[k] = Real(0.5 * (1 + end * p.z)) * along[k % 3] + Vec{0, 0, 0.5 * end * part[k % 3]};
    }
    return all;
  }
};

/// Rational functions on the base, the apex at z = 1.
template <>
struct Reference<Pyramid5> {
  static std::array<Vec, 5> corners() {
    return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 1}}};
  }
  static std::array<GaussPoint, 5> points() {
    const Real a = std::sqrt(32.0 / 135);
    return {{{{-a, -a, 1.0 / 6}, 9.0 / 32},
             {{a, -a, 1.0 / 6}, 9.0 / 32},
             {{a, a, 1.0 / 6}, 9.0 / 32},
             {{-a, a, 1.0 / 6}, 9.0 / 32},
             {{0, 0, 0.7}, 5.0 / 24}}};
  }
  static std::array<Vec, 5> slopes(const Vec& p) {
    std::array<Vec, 5> all;
    const Real up = 1 - p.z;
    for (Index k = 0; k < 4; ++k) {
      const Vec c = corners()[k];
      const Real a = up + p.x * c.x, b = up + p.y * c.y;
      all[k] = Real(0.25 / up) * Vec{c.x * b, c.y * a, a * b / up - a - b};
    }
    all[4] = {0, 0, 1};
    return all;
  }
};

template <>
struct Reference<Hex8OnePoint> : Reference<Hex8> {};

/// Gradients and volumes at the Gauss points of a stress-free element, and its hourglass springs.
template <class Shape>
struct ElementGeometry {
  Vec gradient[Shape::points][Shape::nodes];
  Real volume[Shape::points];
  Real hourglass[13] = {};

  ElementGeometry(const Vec* x, Real young_modulus) {
    if constexpr (Shape::hourglass)
      take_mean(ElementGeometry<Hex8>(x, young_modulus), x, young_modulus);
    else
      take_points(x);
  }
  Real whole() const {
    Real sum = 0;
    for (const Real v : volume) sum += v;
    return sum;
  }

 private:
  void take_points(const Vec* x) {
    const auto points = Reference<Shape>::points();
    for (Index q = 0; q < Shape::points; ++q) {
      const auto slopes = Reference<Shape>::slopes(points[q].at);
      Mat jacobian{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  // dX/dr
      for (Index k = 0; k < Shape::nodes; ++k) add_outer(jacobian, x[k], slopes[k]);
      const Mat back = transpose(inverse(jacobian));
      for (Index k = 0; k < Shape::nodes; ++k) gradient[q][k] = back * slopes[k];
      volume[q] = points[q].weight * determinant(jacobian);
    }
  }
  void take_mean(const ElementGeometry<Hex8>& full, const Vec* x, Real young_modulus) {
    volume[0] = full.whole();
    for (Index k = 0; k < 8; ++k) {
      gradient[0][k] = {0, 0, 0};
      for (Index q = 0; q < 8; ++q)
        gradient[0][k] = gradient[0][k] + Real(full.volume[q] / volume[0]) * full.gradient[q][k];
    }
    for (Index k = 0; k < 8; ++k) {
      const Vec c = Reference<Hex8>::corners()[k];
      const Real pattern[4] = {c.x * c.y, c.y * c.z, c.z * c.x, c.x * c.y * c.z};
      for (Index a = 0; a < 4; ++a)
        put(hourglass + 3 * a, vector_at(hourglass + 3 * a) + pattern[a] * x[k]);
    }
    hourglass[12] = young_modulus * std::cbrt(volume[0]) / 48;
  }
};

/// Isotropic rock.
struct Rock {
  Real lambda = 4e9, mu = 4e9;  // [Pa]
  Real young_modulus() const { return mu * (3 * lambda + 2 * mu) / (lambda + mu); }
};

/// Elements of one shape that share no nodes, each a distorted reference element of about 1 m.
template <class Shape>
struct Elements {
  static constexpr Index nodes = Shape::nodes;
  Index count, stride;
  std::vector<Vec> reference;  // stress-free positions  [m]
  std::vector<Real> motion;    // rows of 8
  std::vector<Index> node, material, law{0};
  std::vector<Real> gradient, volume, hourglass, lambda, mu;
  std::vector<ElementGeometry<Shape>> geometry;

  Elements(Index how_many, Random& random, Real distortion = 0.15, Rock rock = {})
      : count(how_many),
        stride(padded_stride(how_many)),
        motion(8 * std::size_t(nodes) * stride),
        node(std::size_t(nodes) * stride),
        material(stride),
        gradient(std::size_t(Shape::points) * (nodes - 1) * 3 * stride),
        volume(std::size_t(Shape::points) * stride),
        hourglass(13 * std::size_t(stride)),
        lambda{rock.lambda},
        mu{rock.mu} {
    for (Index e = 0; e < stride; ++e) {  // a lane may read past the last
      std::array<Vec, nodes> x = Reference<Shape>::corners();
      for (Vec& corner : x) corner = corner + random.vector(distortion);
      const ElementGeometry<Shape> g(x.data(), rock.young_modulus());
      geometry.push_back(g);
      for (Index k = 0; k < nodes; ++k) {
        reference.push_back(x[k]);
        node[k * stride + e] = e * nodes + k;
        place(e, k, x[k]);
        for (Index q = 0; q < Shape::points && k > 0; ++q) {
          const Index row = (q * (nodes - 1) + k - 1) * 3;
          gradient[row * stride + e] = g.gradient[q][k].x;
          gradient[(row + 1) * stride + e] = g.gradient[q][k].y;
          gradient[(row + 2) * stride + e] = g.gradient[q][k].z;
        }
      }
      for (Index q = 0; q < Shape::points; ++q) volume[q * stride + e] = g.volume[q];
      for (Index k = 0; k < 13; ++k) hourglass[k * stride + e] = g.hourglass[k];
    }
  }
  Elements(const Elements&) = delete;

  void place(Index e, Index k, const Vec& x) { put(motion.data() + 8 * (e * nodes + k), x); }
  void move(Index e, Index k, const Vec& v) { put(motion.data() + 8 * (e * nodes + k) + 4, v); }
  Vec rest(Index e, Index k) const { return reference[e * nodes + k]; }
  Vec position(Index e, Index k) const { return vector_at(motion.data() + 8 * (e * nodes + k)); }
  Vec velocity(Index e, Index k) const {
    return vector_at(motion.data() + 8 * (e * nodes + k) + 4);
  }
  ElementColumns<Shape> columns() const {
    return {{motion.data()},           {node.data(), stride},
            {gradient.data(), stride}, {volume.data(), stride},
            {material.data(), stride}, {lambda.data(), mu.data(), law.data(), nullptr},
            {hourglass.data(), stride}};
  }
  /// Run a kernel for all elements, in tiles of one block; rows by element and corner  [N].
  template <class Kernel>
  void run(const Kernel& kernel, std::vector<Real>& corner_force) const {
    std::vector<Index> first, node_first, own, place(node.size());
    for (Index e = 0; e < count; ++e) {
      if (e % block_size == 0) {
        first.push_back(e / block_size);
        node_first.push_back(e * nodes);
      }
      for (Index k = 0; k < nodes; ++k) {
        own.push_back(e * nodes + k);
        place[k * stride + e] = e % block_size * nodes + k;
      }
    }
    const Index tiles = Index(first.size());
    first.push_back(tiles);
    node_first.push_back(count * nodes);
    for_each_tile({}, count, Blocks{},
                  Tiles{.count = tiles,
                        .block_first = first.data(),
                        .node_first = node_first.data(),
                        .node = own.data(),
                        .row = own.data(),
                        .place = {place.data(), stride},
                        .corner_first = nullptr,
                        .corner = nullptr,
                        .motion = motion.data(),
                        .force = corner_force.data()},
                  kernel);
  }
};

}  // namespace cdem::test
