// scene.hpp - a model of a few blocks of one element each, made without Python.
#pragma once

#include <array>
#include <functional>
#include <type_traits>
#include <vector>

#include "core/model/model.hpp"
#include "core/model/state.hpp"
#include "core/run/run.hpp"
#include "tests/core/elements/reference.hpp"
#include "tests/core/interfaces/joint.hpp"

namespace cdem::test {

/// Append an item to an array.
template <class T>
void push(Column<T>& column, std::type_identity_t<T> value) {
  column.resize(column.size() + 1, value);
}

/// Blocks of one element each. Add blocks, `build`, change the model, `start`.
class Scene {
 public:
  Model model;
  State state;
  Rock rock{4e7, 4e7};  // soft, so that steps are long  [Pa]
  Real density = 2500;  // [kg/m3]
  bool bonded = false;  // faces that lie on each other are bonded

  /// Each returns the number of the new block.
  template <class Shape>
  Index add(const std::array<Vec, Shape::nodes>& corners, bool fixed = false);
  Index add_box(const Vec& low, const Vec& size, bool fixed = false);
  /// A tet of about a size, anywhere turned.
  Index add_tet(Random& random, const Vec& center, Real size, bool fixed = false);

  /// Make the model, and a state in which all stands still.
  void build();
  /// Parameters of the one interface by name, those that are not named being 0 (an angle is its
  /// tangent). Its stiffness is the stiffer side's modulus over its height.
  void set_interface(const Named& parameters);
  void change_interface(Index number, const std::function<void(Interface&)>& change);
  /// Ready for steps.
  void start() { prepare(model, state); }
  void step(std::int64_t steps) { run(model, state, {.steps = steps}); }

  Index first_node(Index block) const { return blocks_[block].first; }
  Index node_count(Index block) const { return blocks_[block].nodes; }
  Real* motion(Index node) { return on_host(state.nodes.motion).data() + 8 * std::size_t(node); }
  Vec position(Index node) const {
    return vector_at(on_host(state.nodes.motion).data() + 8 * node);
  }
  Vec velocity(Index node) const {
    return vector_at(on_host(state.nodes.motion).data() + 8 * node + 4);
  }
  /// A block moves as a rigid body, spinning about the mean of its nodes.
  void set_motion(Index block, const Vec& velocity, const Vec& spin = {0, 0, 0});

 private:
  struct Block {
    Index first, nodes;
    bool fixed;
    std::vector<Real> gradient, volume;  // as the tables have them, one below the other
    std::vector<std::array<Index, 4>> faces;
    Real whole, mass, frequency_squared, triangle, quad;
  };
  std::vector<Vec> position_;
  std::vector<Block> blocks_;

  void build_nodes();
  void build_elements();
  void build_shape(ElementSet& e, Index nodes, Index points);
  Index element_of(std::size_t block) const;
  void build_faces();
  void build_edges();
  void build_pairs();
  void build_pair_set(PairSet& p, Index points, const std::vector<std::array<Index, 2>>& faces);
  void build_corners();
  void build_loads();
};

}  // namespace cdem::test
