// multigrid.hpp - an approximate inverse of a system of nodes: smoothing in blocks of elements, and
// ever coarser spaces below.
#pragma once

#include <vector>

#include "core/rest/aggregation.hpp"
#include "core/rest/node_system.hpp"

namespace cdem {

/// A matrix with what smooths its residuals.
struct Level {
  BlockRows matrix, up, down;      // up: from the next level; down: its transpose
  Column<Index> group_first;       // [group + 1] numbers of a vector
  Column<std::size_t> inverse_of;  // [group + 1] where a group's matrix begins
  Column<Real> inverse;            // of the diagonal blocks of groups
  Real weight = 0;
  Column<Real> right, x, left;  // vectors: right side, answer, residual
};

/// Symmetric V-cycle. The first step joins nodes that bonds hold in one place, the next ones join
/// aggregates, until few numbers are left, which are solved for directly.
class Multigrid {
 public:
  /// Takes the matrix of the system.
  explicit Multigrid(NodeSystem&& system);

  const BlockRows& matrix() const { return levels_.front().matrix; }
  /// z = M^-1 r, about A^-1 r.
  void apply(Queue queue, const Real* r, Real* z);
  std::size_t levels() const { return levels_.size(); }

 private:
  void cycle(Queue queue, std::size_t level, const Real* right, Real* x);
  void solve_last(const Real* right, Real* x) const;

  std::vector<Level> levels_;
  std::vector<Real> last_;  // inverse of the last matrix
};

}  // namespace cdem
