// ground.cpp - see ground.hpp.
#include "core/nodes/ground.hpp"

#include <algorithm>
#include <vector>

namespace cdem {

void list_ground(const Model& m, State& s) {
  std::vector<Index> row(m.node_count, -1), node;
  std::vector<Real> matrix;
  Modules::for_each([&]<class Module>() {
    if constexpr (requires { Module::dashpots(given_of<Module>(m), state_of<Module>(s)); })
      for (const NodeDashpot& one : Module::dashpots(given_of<Module>(m), state_of<Module>(s))) {
        Index& place = row[one.node];
        if (place < 0) {
          place = Index(node.size());
          node.push_back(one.node);
          matrix.resize(8 * node.size());
        }
        for (std::size_t k = 0; k < 6; ++k) matrix[8 * std::size_t(place) + k] += one.matrix[k];
      }
  });
  GroundState& ground = s.ground;
  if (node.empty()) row.clear();
  ground.row.assign(row);
  ground.node.assign(node);
  ground.matrix.assign(matrix);
  ground.force.resize(4 * node.size());
  if (node.empty()) return;
  s.nodes.radiated.resize(m.node_count);
  s.nodes.radiated_sample.resize(m.node_count);
}

}  // namespace cdem
