// nodal_dilatation.hpp - tets that flow, with the dilatation averaged at the nodes of their block.
#pragma once

#include "core/elements/corotational.hpp"

namespace cdem {

/// Elastic dilatation of tets as their nodes see it: theta_n = sum_f V_f theta_f / sum_f V_f over
/// the tets f of a node, theta the trace of the elastic strain less its initial value. The
/// energy of a block is the sum over its nodes, sum_n V_n / 4 K / 2 theta_n^2, V_n the volume of
/// the tets of node n. Its derivative is the pressure K (mean of theta_n over the four nodes), so
/// energy, momentum and frame invariance are exact; see docs/theory/elements.md.
struct NodalDilatation {
  InIndices tet_nodes;   // [4][tet]
  InFlags averaged;      // [tet] 1: it is averaged
  InTable start;         // [1][tet] elastic dilatation at the start, not averaged
  const Real* at_nodes;  // [node] theta_n

  /// Mean of a number of the four nodes; where all are the same, it is that to the bit.
  template <class I, class Of>
  CDEM_HD Number<I> mean(I e, const Of& of) const {
    const auto at = [&](Index k) { return of(tet_nodes.at(k, e)); };
    return Number<I>(0.25) * ((at(0) + at(1)) + (at(2) + at(3)));
  }
  template <class I>
  CDEM_HD Number<I> mean(I e) const {
    return mean(e, [&](const auto& node) { return look_up(at_nodes, node); });
  }
  /// The elastic strain of a tet with the dilatation that its nodes give it.
  template <class I, class T = Number<I>>
  CDEM_HD Sym3<T> of(I e, const Sym3<T>& strain) const {
    return select(averaged.equal(1, e), with_trace(strain, start.at(0, e) + mean(e)), strain);
  }
};

/// Pass 1: elastic dilatation since the start, before the laws move on.
struct FindDilatation {
  ElementColumns<Tet4> columns;
  PointFlow<Tet4> flow;
  InTable start;   // [1][tet]
  InOutTable own;  // [1][tet]

  template <class I>
  CDEM_HD void operator()(I e) const {
    const PointStrains<Tet4, FollowRotation, Number<I>> p(columns, e, flow.may_flow());
    own.set(0, e, trace(flow.elastic_part(columns, e, p).part[0]) - start.at(0, e));
  }
};

/// After passes 1 and 2: the mean at the nodes, in the order of their tets.
struct AverageAtNodes {
  const Index* nodes;
  const Index *first, *tets;  // of a node
  const Real *volume, *own;   // [tet]
  Real* at_nodes;             // [node]

  CDEM_HD void operator()(One item) const {
    const Index node = nodes[item.i];
    Real sum = 0, whole = 0;
    for (Index c = first[node]; c < first[node + 1]; ++c) {
      const Index tet = tets[c];
      sum += volume[tet] * own[tet];
      whole += volume[tet];
    }
    at_nodes[node] = whole > 0 ? sum / whole : 0;
  }
};

/// Pass 2: the laws move on by one step, and book their work but for what the mean pressure after
/// it does on the dilatation that flowed. The dilatation after it is averaged next.
struct FlowOfTets {
  ElementColumns<Tet4> columns;
  PointFlow<Tet4> flow;
  NodalDilatation trial, before;  // of this step, and after the last one
  InOutTable own;                 // [1][tet] dilatation since the start
  InOutTable flowed;              // [1][tet] of it, the plastic part of this step

  template <class I>
  CDEM_HD void operator()(I e) const {
    using T = Number<I>;
    const PointStrains<Tet4, FollowRotation, T> p(columns, e, flow.may_flow());
    ElasticStrains<Tet4, T> strains = flow.elastic_part(columns, e, p);
    strains.part[0] = trial.of(e, strains.part[0]);
    Sym3<T> increment[1];
    const T none(0.0);
    T dilatation = none;
    if (any_of(flow.flow_on(columns, e, strains, increment))) {
      const auto averaged = trial.averaged.equal(1, e);
      dilatation = select(averaged, trace(increment[0]), none);
      book(e, averaged, strains.part[0], increment[0]);
      own.set(0, e, own.at(0, e) - dilatation);
    }
    flowed.set(0, e, dilatation);
  }

 private:
  template <class I, class T>
  CDEM_HD void book(I e, const Truth<T>& averaged, const Sym3<T>& strain,
                    const Sym3<T>& increment) const {
    const ElasticConstants<T> elastic = columns.elastic(e);
    const Sym3<T> was =
        before.of(e, flow.template elastic_part_before<FollowRotation>(columns, e).part[0]);
    Sym3<T> is = elastic.stress(strain);
    is = select(averaged, with_trace(is, T(0.0)), is);
    const T spent =
        T(0.5) * columns.point_volume.at(0, e) * contract(elastic.stress(was) + is, increment);
    // what mean pressures do in one tet may be less than nothing: it comes from its neighbours
    const T lost = select(averaged, spent, max_of(spent, T(0.0)));
    flow.work.set(0, e, flow.work.at(0, e) + lost);
    flow.add_inelastic(e, 0, increment);
  }
};

/// Pass 3 is CorotationalForce with this: the laws have moved on, the mean pressure acts.
struct NodalFlow {
  PointFlow<Tet4> flow;
  NodalDilatation after;
  InTable flowed;  // [1][tet]

  CDEM_HD bool may_flow() const { return flow.may_flow(); }

  template <class I, class Rotation, class T = Number<I>>
  CDEM_HD ElasticStrains<Tet4, T> move_on(const ElementColumns<Tet4>& c, I e,
                                          const PointStrains<Tet4, Rotation, T>& p) const {
    ElasticStrains<Tet4, T> strains = flow.elastic_part(c, e, p);
    strains.part[0] = after.of(e, strains.part[0]);
    const T dilatation = flowed.at(0, e), none(0.0);
    if (any_of((dilatation < none) | (dilatation > none))) {
      const T pressure = trace(c.elastic(e).stress(strains.part[0])) / T(3.0);
      const T work = T(0.5) * c.point_volume.at(0, e) * (pressure * dilatation);
      flow.work.set(0, e, flow.work.at(0, e) + work);
    }
    return strains;
  }
};

/// For CorotationalReport: result of the laws for the mean dilatation at present positions.
struct NodalReport {
  PointFlow<Tet4> flow;
  NodalDilatation now;
  InTable own;  // [1][tet] dilatation since the start

  CDEM_HD bool may_flow() const { return flow.may_flow(); }

  template <class I, class Rotation, class T = Number<I>>
  CDEM_HD ElasticStrains<Tet4, T> elastic_part(const ElementColumns<Tet4>& c, I e,
                                               const PointStrains<Tet4, Rotation, T>& p) const {
    ElasticStrains<Tet4, T> strains = flow.elastic_part(c, e, p);
    strains.part[0] = now.of(e, strains.part[0]);
    return strains;
  }
  template <class I, class T = Number<I>>
  CDEM_HD ElasticStrains<Tet4, T> after_flow(const ElementColumns<Tet4>& c, I e,
                                             const ElasticStrains<Tet4, T>& strains,
                                             T& yielded) const {
    return flow.after_flow(c, e, strains, yielded);
  }
  /// Excess of a tet's share of its nodes' energy over 1/2 K (start + mean)^2.
  template <class I, class T = Number<I>>
  CDEM_HD T more_energy(const ElementColumns<Tet4>& c, I e) const {
    const ElasticConstants<T> elastic = c.elastic(e);
    const T bulk = elastic.lambda + T(2.0 / 3.0) * elastic.mu, mean = now.mean(e);
    const T squares = now.mean(e, [&](const auto& node) {
      const T theta = look_up(now.at_nodes, node);
      return theta * theta;
    });
    const T more = T(0.5) * (squares - mean * mean) + now.start.at(0, e) * (own.at(0, e) - mean);
    return select(now.averaged.equal(1, e), bulk * c.point_volume.at(0, e) * more, T(0.0));
  }
};

}  // namespace cdem
