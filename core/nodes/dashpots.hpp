// dashpots.hpp - dashpots between nodes and the ground, taken implicitly.
//
// A dashpot acts with the mean of the velocities before and after the step (Lysmer & Kuhlemeyer
// 1969; the mean keeps central differences stable at any C, and their step unchanged):
//
//   v+ = v- + (m/tau I + C/2)^-1 (f - C v-),  force -C (v- + v+)/2,  tau half of both steps
//
// Nodes that have one move lumped masses.
#pragma once

#include "core/base/views.hpp"
#include "core/nodes/supports.hpp"

namespace cdem {

/// No node has dashpots: kernels skip their code.
struct NoDashpots {
  static constexpr bool any = false;
};

/// Dashpots of nodes: a symmetric matrix C each.
struct Dashpots {
  static constexpr bool any = true;
  const Index* row;    // [node] of the following arrays, or -1
  const Real* matrix;  // rows of 8: xx yy zz xy yz zx, two pads  [kg/s]
  Real* force;         // rows of 4: of this step  [N]
  Real* radiated;      // [node] work that they have taken so far  [J]

  CDEM_HD bool act_on(Index node) const { return row[node] >= 0; }
  /// Change of the velocity of a node in a step; components that a support gives have no dashpots.
  CDEM_HD Row change(Index node, const SupportColumns& supports, const Row& f, const Row& v,
                     Real mass_over_kick) const {
    const Real* c = matrix + std::size_t(row[node]) * 8;
    const Real x = supports.given(node, 0) ? 0.0 : 1.0, y = supports.given(node, 1) ? 0.0 : 1.0,
               z = supports.given(node, 2) ? 0.0 : 1.0;
    const Real xx = x * c[0], yy = y * c[1], zz = z * c[2];
    const Real xy = x * y * c[3], yz = y * z * c[4], zx = z * x * c[5];
    const Vec3<Real> damped{xx * v.n[0] + xy * v.n[1] + zx * v.n[2],
                            xy * v.n[0] + yy * v.n[1] + yz * v.n[2],
                            zx * v.n[0] + yz * v.n[1] + zz * v.n[2]};
    const Vec3<Real> need{f.n[0] - damped.x, f.n[1] - damped.y, f.n[2] - damped.z};
    // L D L^T of m/tau I + C/2, which is positive definite
    const Real d0 = mass_over_kick + 0.5 * xx;
    const Real l10 = 0.5 * xy / d0, l20 = 0.5 * zx / d0;
    const Real d1 = mass_over_kick + 0.5 * yy - l10 * (0.5 * xy);
    const Real l21 = (0.5 * yz - l20 * (0.5 * xy)) / d1;
    const Real d2 = mass_over_kick + 0.5 * zz - l20 * (0.5 * zx) - l21 * l21 * d1;
    const Real b1 = need.y - l10 * need.x, b2 = need.z - l20 * need.x - l21 * b1;
    const Real dz = b2 / d2, dy = b1 / d1 - l21 * dz, dx = need.x / d0 - l10 * dy - l20 * dz;
    const Vec3<Real> mean{v.n[0] + 0.5 * dx, v.n[1] + 0.5 * dy, v.n[2] + 0.5 * dz};
    Row::of(-(xx * mean.x + xy * mean.y + zx * mean.z), -(xy * mean.x + yy * mean.y + yz * mean.z),
            -(zx * mean.x + yz * mean.y + zz * mean.z))
        .store(force + std::size_t(row[node]) * 4);
    return Row::of(dx, dy, dz);
  }
  /// Force on a node in this step; after `change`.
  CDEM_HD Row force_on(Index node) const { return Row::at(force + std::size_t(row[node]) * 4); }
};

/// Work of the dashpots in the half step that follows, which `radiated` contains already.
struct SampleDashpots {
  const Index* node;  // [row]
  InMotion nodes;     // velocity: after
  const Real* force;  // [row] rows of 4
  Real dt;
  Real* sample;  // [node]  [J]

  CDEM_HD void operator()(One row) const {
    const Vec3<Real> f = Row::at(force + std::size_t(row.i) * 4).vector();
    sample[node[row.i]] = -0.5 * dt * dot(f, nodes.velocity(node[row.i]));
  }
};

}  // namespace cdem
