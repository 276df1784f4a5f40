// scene.cpp - see scene.hpp.
#include "tests/core/scene.hpp"

#include <map>
#include <utility>

#include "core/materials/laws.hpp"
#include "core/model/init_state.hpp"
#include "core/model/interface_table.hpp"

namespace cdem::test {

namespace {

/// Faces of a shape, outward, counter-clockwise seen from outside; -1 after a triangle. And volume
/// over area and height of its triangles and quadrilaterals.
template <class Shape>
struct FacesOf;
template <>
struct FacesOf<Tet4> {
  static constexpr Real triangle = 3, quad = 0;
  static std::vector<std::array<Index, 4>> all() {
    return {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}};
  }
};
template <>
struct FacesOf<Pyramid5> {
  static constexpr Real triangle = 3, quad = 3;
  static std::vector<std::array<Index, 4>> all() {
    return {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}};
  }
};
template <>
struct FacesOf<Wedge6> {
  static constexpr Real triangle = 1, quad = 2;
  static std::vector<std::array<Index, 4>> all() {
    return {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  }
};
template <>
struct FacesOf<Hex8> {
  static constexpr Real triangle = 0, quad = 1;
  static std::vector<std::array<Index, 4>> all() {
    return {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  }
};

}  // namespace

template <class Shape>
Index Scene::add(const std::array<Vec, Shape::nodes>& corners, bool fixed) {
  Block block{Index(position_.size()), Shape::nodes, fixed, {}, {}, {}, 0, 0, 0, 0, 0};
  const ElementGeometry<Shape> g(corners.data(), rock.young_modulus());
  Real squares = 0;
  for (Index q = 0; q < Shape::points; ++q) {
    block.volume.push_back(g.volume[q]);
    for (Index k = 0; k < Shape::nodes; ++k) {
      squares += g.volume[q] * dot(g.gradient[q][k], g.gradient[q][k]);
      if (k == 0) continue;
      block.gradient.push_back(g.gradient[q][k].x);
      block.gradient.push_back(g.gradient[q][k].y);
      block.gradient.push_back(g.gradient[q][k].z);
    }
  }
  block.whole = g.whole();
  REQUIRE(block.whole > 0);
  block.mass = density * block.whole / Shape::nodes;
  block.frequency_squared = (rock.lambda + 4 * rock.mu) * squares / block.mass;
  block.triangle = FacesOf<Shape>::triangle;
  block.quad = FacesOf<Shape>::quad;
  block.faces = FacesOf<Shape>::all();
  position_.insert(position_.end(), corners.begin(), corners.end());
  blocks_.push_back(block);
  return Index(blocks_.size()) - 1;
}
template Index Scene::add<Tet4>(const std::array<Vec, 4>&, bool);
template Index Scene::add<Pyramid5>(const std::array<Vec, 5>&, bool);
template Index Scene::add<Wedge6>(const std::array<Vec, 6>&, bool);
template Index Scene::add<Hex8>(const std::array<Vec, 8>&, bool);

Index Scene::add_box(const Vec& low, const Vec& size, bool fixed) {
  std::array<Vec, 8> x = Reference<Hex8>::corners();
  for (Vec& c : x)
    c = low + Real(0.5) * Vec{size.x * (1 + c.x), size.y * (1 + c.y), size.z * (1 + c.z)};
  return add<Hex8>(x, fixed);
}

Index Scene::add_tet(Random& random, const Vec& center, Real size, bool fixed) {
  const Mat turn = random.rotation();
  const std::array<Vec, 4> regular = {{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}};
  std::array<Vec, 4> x;
  for (Index k = 0; k < 4; ++k)
    x[k] = center + Real(0.5 * size) * (turn * (regular[k] + random.vector(0.3)));
  if (dot(cross(x[1] - x[0], x[2] - x[0]), x[3] - x[0]) < 0) std::swap(x[2], x[3]);
  return add<Tet4>(x, fixed);
}

void Scene::set_motion(Index block, const Vec& velocity, const Vec& spin) {
  const Block& b = blocks_[block];
  Vec center{0, 0, 0};
  for (Index i = b.first; i < b.first + b.nodes; ++i)
    center = center + Real(1.0 / b.nodes) * position(i);
  for (Index i = b.first; i < b.first + b.nodes; ++i)
    put(motion(i) + 4, velocity + cross(spin, position(i) - center));
}

void Scene::build() {
  build_nodes();
  build_elements();
  build_faces();
  build_edges();
  build_pairs();
  build_corners();
  build_loads();
  std::vector<Real> positions;
  for (const Vec& x : position_)
    for (const Real component : {x.x, x.y, x.z}) positions.push_back(component);
  init_state(model, state, positions.data());
}

/// Tets have the exact mass matrix, which all share; other shapes have lumped masses.
void Scene::build_nodes() {
  Model& m = model;
  m.node_count = Index(position_.size());
  for (Index j = 0; j < 4; ++j)
    for (Index k = 0; k < 4; ++k) {
      push(m.mass_inverse, j == k ? 4 : -1);
      push(m.mass_matrix, j == k ? 0.4 : 0.2);
    }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    const bool exact = block.nodes == 4 && !block.fixed;
    for (Index k = 0; k < block.nodes; ++k) {
      const Vec& x = position_[block.first + k];
      Index place = 0;
      while (distance(position_[place], x) > 0) ++place;
      push(m.node_block, Index(b));
      push(m.node_place, place);
      push(m.mass, block.mass);
      push(m.gravity_mass, block.mass);
      push(m.mass_row_first, exact ? 4 * k : -1);
      push(m.mass_axis_stride, 0);
      push(m.block_first, block.first);
      push(m.block_count, block.nodes);
      push(m.inverse_mass_bound, (exact ? 5 : 1) / block.mass);
      push(m.frequency_squared, (exact ? 5 : 1) * block.frequency_squared);
      push(m.lumped_frequency_squared, block.frequency_squared);
    }
  }
}

void Scene::build_elements() {
  build_shape(model.tet4, 4, 1);
  build_shape(model.pyramid5, 5, 5);
  build_shape(model.wedge6, 6, 6);
  build_shape(model.hex8, 8, 8);
  push(model.material_lambda, rock.lambda);
  push(model.material_mu, rock.mu);
  push(model.material_law, 0);
  model.material_parameters.resize(material_row);
}

void Scene::build_shape(ElementSet& e, Index nodes, Index points) {
  std::vector<const Block*> some;
  for (const Block& b : blocks_)
    if (b.nodes == nodes) some.push_back(&b);
  e.corners = nodes;
  e.points = points;
  e.count = Index(some.size());
  e.stride = padded_stride(e.count);
  e.nodes.resize(std::size_t(nodes) * e.stride);
  e.material.resize(e.stride);
  e.gradient.resize(std::size_t(points) * (nodes - 1) * 3 * e.stride);
  e.volume.resize(std::size_t(points) * e.stride);
  for (Index i = 0; i < e.stride && e.count > 0; ++i) {
    const Block& b = *some[std::min(i, e.count - 1)];
    for (Index k = 0; k < nodes; ++k) on_host(e.nodes)[k * e.stride + i] = b.first + k;
    for (std::size_t r = 0; r < b.gradient.size(); ++r)
      on_host(e.gradient)[r * e.stride + i] = b.gradient[r];
    for (std::size_t r = 0; r < b.volume.size(); ++r)
      on_host(e.volume)[r * e.stride + i] = b.volume[r];
  }
}

/// Number of a block's element among all, shape by shape.
Index Scene::element_of(std::size_t block) const {
  Index number = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    number += blocks_[b].nodes < blocks_[block].nodes ||
              (blocks_[b].nodes == blocks_[block].nodes && b < block);
  return number;
}

void Scene::build_faces() {
  Model& m = model;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    for (const auto& corners : blocks_[b].faces) {
      const Index count = corners[3] < 0 ? 3 : 4;
      Vec x[4], center{0, 0, 0};
      for (Index k = 0; k < count; ++k) {
        push(m.face_nodes, blocks_[b].first + corners[k]);
        x[k] = position_[blocks_[b].first + corners[k]];
        center = center + Real(1.0 / count) * x[k];
      }
      if (count == 3) push(m.face_nodes, -1), x[3] = x[2];
      Real sum = 0, farthest = 0;
      for (Index k = 0; k < count; ++k) {
        sum += distance(x[k], center);
        farthest = std::max(farthest, distance(x[k], center));
      }
      const Real area = 0.5 * norm(cross(x[2] - x[0], x[3] - x[1]));
      const Real height =
          (count == 3 ? blocks_[b].triangle : blocks_[b].quad) * blocks_[b].whole / area;
      push(m.face_interface_class, 0);
      push(m.face_block, Index(b));
      push(m.face_element, element_of(b));
      push(m.face_length, sum / count);
      push(m.face_reach, 1.5 * farthest);
      push(m.face_area, area);
      push(m.face_height, height);
      push(m.face_stiffness, rock.young_modulus() / height);
      push(m.face_initially_exposed, 1);
      push(m.face_movable, !blocks_[b].fixed);
      push(m.face_radius, blocks_[b].fixed ? 1e300 : std::cbrt(0.75 / M_PI * blocks_[b].whole));
      ++m.face_count;
    }
}

void Scene::build_edges() {
  Model& m = model;
  std::map<std::pair<Index, Index>, Index> edges;
  m.face_edges.resize(4 * std::size_t(m.face_count), -1);
  for (Index f = 0; f < m.face_count; ++f) {
    const Index* nodes = m.face_nodes.data() + 4 * f;
    const Index count = nodes[3] < 0 ? 3 : 4;
    for (Index k = 0; k < count; ++k) {
      const auto ends = std::minmax(nodes[k], nodes[(k + 1) % count]);
      const auto [place, is_new] = edges.insert({ends, m.edge_count});
      if (is_new) {
        push(m.edge_nodes, ends.first), push(m.edge_nodes, ends.second);
        push(m.edge_faces, f), push(m.edge_faces, -1);
        ++m.edge_count;
      } else {
        on_host(m.edge_faces)[2 * place->second + 1] = f;
      }
      on_host(m.face_edges)[4 * f + k] = place->second;
    }
  }
  for (Index i = 0; i < m.node_count; ++i) {
    push(m.edge_star_first, Index(m.edge_star.size()));
    for (Index e = 0; e < m.edge_count; ++e)
      for (const Index end : {0, 1})
        if (on_host(m.edge_nodes)[2 * e + end] == i)
          push(m.edge_star, on_host(m.edge_nodes)[2 * e + 1 - end]);
  }
  push(m.edge_star_first, Index(m.edge_star.size()));
}

/// Conforming pairs, where the faces of two blocks have their corners at the same places.
void Scene::build_pairs() {
  Model& m = model;
  std::vector<std::array<Index, 2>> found[2];
  const auto places = [&](Index f) {
    std::array<Index, 4> at;
    for (Index k = 0; k < 4; ++k) {
      const Index node = on_host(m.face_nodes)[4 * f + k];
      at[k] = node < 0 ? -1 : on_host(m.node_place)[node];
    }
    std::sort(at.begin(), at.end());
    return at;
  };
  for (Index a = 0; a < m.face_count && bonded; ++a)
    for (Index b = a + 1; b < m.face_count; ++b)
      if (on_host(m.face_block)[a] != on_host(m.face_block)[b] && places(a) == places(b)) {
        found[on_host(m.face_nodes)[4 * a + 3] < 0 ? 0 : 1].push_back({a, b});
        on_host(m.face_initially_exposed)[a] = on_host(m.face_initially_exposed)[b] = 0;
      }
  build_pair_set(m.triangles, 3, found[0]);
  build_pair_set(m.quads, 4, found[1]);
  build_pair_set(m.overlaps, 1, {});
  m.overlaps.corners = 8;
  push(m.overlaps.point_first, 0);
}

void Scene::build_pair_set(PairSet& p, Index points,
                           const std::vector<std::array<Index, 2>>& faces) {
  Model& m = model;
  p.count = Index(faces.size());
  p.stride = p.point_stride = padded_stride(p.count);
  p.points = p.corners = points;
  p.corner_first = m.corner_rows;
  m.corner_rows += points * p.count;
  p.nodes.resize(2 * std::size_t(points) * p.stride);
  p.interface.resize(p.stride);
  p.area.resize(p.stride, 1.0);
  p.stiffness.resize(2 * std::size_t(p.stride), 1.0);
  for (Index i = 0; i < p.count; ++i) {
    const auto [a, b] = faces[i];
    push(p.faces, a), push(p.faces, b);
    on_host(p.area)[i] = on_host(m.face_area)[a];
    on_host(p.stiffness)[i] = on_host(p.stiffness)[p.stride + i] =
        std::max(on_host(m.face_stiffness)[a], on_host(m.face_stiffness)[b]);
    for (Index k = 0; k < points; ++k) {
      const Index node = on_host(m.face_nodes)[4 * a + k];
      on_host(p.nodes)[k * p.stride + i] = node;
      for (Index j = 0; j < points; ++j)
        if (on_host(m.node_place)[on_host(m.face_nodes)[4 * b + j]] == on_host(m.node_place)[node])
          on_host(p.nodes)[(points + k) * p.stride + i] = on_host(m.face_nodes)[4 * b + j];
    }
  }
}

void Scene::build_corners() {
  Model& m = model;
  std::vector<std::vector<Index>> rows(m.node_count);
  for (const PairSet* p : {&m.triangles, &m.quads})
    for (Index i = 0; i < p->count; ++i)
      for (Index k = 0; k < p->points; ++k) {
        const Index row = p->corner_first + i * p->points + k;
        rows[on_host(p->nodes)[k * p->stride + i]].push_back(~row);
        rows[on_host(p->nodes)[(p->points + k) * p->stride + i]].push_back(row);
      }
  for (const auto& of_node : rows) {
    push(m.corner_first, Index(m.corner.size()));
    for (const Index row : of_node) push(m.corner, row);
  }
  push(m.corner_first, Index(m.corner.size()));
}

/// Fixed blocks are held in all directions; curve 0 is constant.
void Scene::build_loads() {
  Model& m = model;
  m.load_first.resize(m.node_count + 1);
  for (const Block& b : blocks_)
    for (Index k = 0; k < b.nodes; ++k) push(m.support, b.fixed ? 0 : -1);
  m.support_component.resize(3, 1);
  m.support_curve.resize(3);
  m.support_velocity.resize(3);
  m.curve_time = {{0}};
  m.curve_factor = {{1}};
  m.class_count = 1;
  push(m.interface_of, 0);
  set_interface({});
}

void Scene::set_interface(const Named& parameters) {
  const Joints joints{parameters};
  model.interfaces.assign(joints.interfaces);
  model.interface_parameters.assign(joints.parameters);
  note_interfaces(model);
}

void Scene::change_interface(Index number, const std::function<void(Interface&)>& change) {
  change(on_host(model.interfaces)[number]);
  note_interfaces(model);
}

}  // namespace cdem::test
