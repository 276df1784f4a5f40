// data.cpp - see data.hpp.
#include "core/surface/data.hpp"

#include "core/base/parallel.hpp"
#include "core/model/model.hpp"
#include "core/model/phase_timer.hpp"
#include "core/model/state.hpp"
#include "core/surface/act_on_faces.hpp"

namespace cdem {

namespace {

/// Store the position of a face, and restart its law.
class Begin {
 public:
  Begin(const cdem::State& s, const SurfaceSet& g, const SurfaceFaces& faces, SurfacePoints& points)
      : faces_(faces),
        nodes_(on_host(faces.nodes)),
        entry_(on_host(faces.entry)),
        law_(on_host(g.law)),
        motion_(on_host(InMotion{s.nodes.motion.data()})),
        place_(on_host(points.place)),
        history_(on_host(points.history)) {}

  Index entry(Index face) const { return entry_[face]; }
  Index node(Index face, Index k) const { return nodes_[std::size_t(k) * faces_.stride + face]; }
  void operator()(Index face) const {
    for (Index k = 0; k < faces_.vertices; ++k) {
      const Vec3<Real> x = motion_.position(node(face, k));
      const Real at[3] = {x.x, x.y, x.z};
      for (Index axis = 0; axis < 3; ++axis) set(place_, 3 * k + axis, face, at[axis]);
      SurfaceLaws::for_each([&]<template <class> class Law, Index number>() {
        if (law_[entry_[face]] != number) return;
        for (Index j = 0; j < state_count<Law>; ++j)
          set(history_, k * SurfaceLaws::most_state + j, face, Law<Real>::state[j].intact);
      });
    }
  }

 private:
  void set(const OnHost<Real>& table, Index row, Index face, Real number) const {
    table[std::size_t(row) * faces_.stride + face] = number;
  }

  const SurfaceFaces& faces_;
  OnHost<const Index> nodes_, entry_, law_;
  InMotion motion_;
  OnHost<Real> place_, history_;
};

/// Call visit(faces, points) for triangles, then for quadrilaterals.
template <class Visit>
void for_each_faces(const SurfaceSet& g, SurfaceState& s, const Visit& visit) {
  visit(g.triangles, s.triangles);
  visit(g.quads, s.quads);
}

/// State variables of laws at a vertex; none if no law of the case has any.
Index state_of_vertex(const SurfaceSet& g) {
  bool any = false;
  SurfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    for (const Index law : on_host(g.law)) any |= state_count<Law> > 0 && law == number;
  });
  return any ? SurfaceLaws::most_state : 0;
}

void size(const SurfaceFaces& faces, SurfacePoints& points, Index states) {
  const std::size_t row = std::size_t(faces.vertices) * faces.stride;
  points.place.resize(3 * row);
  points.history.resize(states * row);
}

/// Factor of every entry in this step, and whether it acts.
void evaluate(const Model& m, cdem::State& all) {
  const SurfaceSet& g = given_of<Surface>(m);
  SurfaceState& s = state_of<Surface>(all);
  s.factor.resize(g.count);
  s.acts.resize(g.count);
  const auto curve = on_host(g.curve);
  const auto begun = on_host(s.begun);
  const auto of_curve = on_host(all.load_factor), factor = on_host(s.factor),
             acts = on_host(s.acts);
  for (Index e = 0; e < g.count; ++e) {
    factor[e] = of_curve[curve[e]];
    acts[e] = begun[e];
  }
}

template <Index count>
void act_on(cdem::State& all, Queue q, const SurfaceSet& g, const SurfaceFaces& faces,
            SurfacePoints& points) {
  const SurfaceState& s = state_of<Surface>(all);
  size(faces, points, state_of_vertex(g));  // a checkpoint may come without
  Real* rows = applied_of<Surface>(all).rows.data() + 4 * std::size_t(faces.row_first);
  for_each_lane(q, faces.count,
                ActOnFaces<SurfaceLaws, count>{.nodes = {all.nodes.motion.data()},
                                               .face_nodes = {faces.nodes.data(), faces.stride},
                                               .entry = {faces.entry.data(), faces.stride},
                                               .entries = {.law = g.law.data(),
                                                           .parameters = g.parameters.data(),
                                                           .factor = s.factor.data(),
                                                           .acts = s.acts.data()},
                                               .place = {points.place.data(), faces.stride},
                                               .state = {points.history.data(), faces.stride},
                                               .out = {rows}});
}

}  // namespace

void Surface::take_widths(Given& g) {
  g.row = surface_row;
  g.most_state = SurfaceLaws::most_state;
}

Real Surface::stiffness_of_entry(const Given& g, Index entry) {
  const auto law = on_host(g.law);
  const auto parameters = on_host(g.parameters);
  Real stiffness = 0;
  SurfaceLaws::for_each([&]<template <class> class Law, Index number>() {
    if constexpr (requires { Law<Real>::stiffness(parameters.data()); })
      if (law[entry] == number)
        stiffness = Law<Real>::stiffness(parameters.data() + std::size_t(entry) * surface_row);
  });
  return stiffness;
}

std::vector<NodeDashpot> Surface::dashpots(const Given& g, const State& s) {
  const auto law = on_host(g.law);
  const auto parameters = on_host(g.parameters);
  const auto begun = on_host(s.begun);
  std::vector<NodeDashpot> found;
  for (const SurfaceFaces* faces : {&g.triangles, &g.quads}) {
    const auto nodes = on_host(faces->nodes), entry = on_host(faces->entry);
    const auto area = on_host(faces->area), normal = on_host(faces->normal),
               rock = on_host(faces->impedance);
    for (std::size_t f = 0; f < std::size_t(faces->count); ++f) {
      const Index e = entry[f];
      if (!begun[e]) continue;
      SurfaceLaws::for_each([&]<template <class> class Law, Index number>() {
        if constexpr (requires { Law<Real>::impedance(nullptr, Impedance{}); }) {
          if (law[e] != number) return;
          const Impedance z = Law<Real>::impedance(parameters.data() + std::size_t(e) * surface_row,
                                                   {rock[2 * f], rock[2 * f + 1]});
          const Real share = area[f] / faces->vertices, more = z.normal - z.shear;
          const Real x = normal[3 * f], y = normal[3 * f + 1], w = normal[3 * f + 2];
          for (Index k = 0; k < faces->vertices; ++k)
            found.push_back(
                {.node = nodes[std::size_t(k) * faces->stride + f],
                 .matrix = {share * (z.shear + more * x * x), share * (z.shear + more * y * y),
                            share * (z.shear + more * w * w), share * more * x * y,
                            share * more * y * w, share * more * w * x}});
        }
      });
    }
  }
  return found;
}

std::vector<Index> Surface::row_nodes(const Model& m, const cdem::State&) {
  const SurfaceSet& g = given_of<Surface>(m);
  std::vector<Index> node;
  for (const SurfaceFaces* faces : {&g.triangles, &g.quads}) {
    const auto nodes = on_host(faces->nodes);
    for (Index f = 0; f < faces->count; ++f)
      for (Index k = 0; k < faces->vertices; ++k)
        node.push_back(nodes[std::size_t(k) * faces->stride + f]);
  }
  return node;
}

void Surface::start(const Model& m, cdem::State& all) {
  const SurfaceSet& g = given_of<Surface>(m);
  SurfaceState& s = state_of<Surface>(all);
  s.begun.resize(g.count);
  const Index states = state_of_vertex(g);
  for_each_faces(g, s, [&](const auto& faces, auto& points) { size(faces, points, states); });
  const auto waits = on_host(g.waits);
  std::vector<Flag> now(g.count);
  for (Index e = 0; e < g.count; ++e) now[e] = !waits[e];
  begin(m, all, now.data());
}

void Surface::begin(const Model& m, cdem::State& all, const Flag* which) {
  const SurfaceSet& g = given_of<Surface>(m);
  SurfaceState& s = state_of<Surface>(all);
  const auto begun = on_host(s.begun);
  for (Index e = 0; e < g.count; ++e) begun[e] |= which[e];
  for_each_faces(g, s, [&](const SurfaceFaces& faces, SurfacePoints& points) {
    const Begin begin(all, g, faces, points);
    for (Index f = 0; f < faces.count; ++f)
      if (which[begin.entry(f)]) begin(f);
  });
}

void Surface::renew(const Model& m, cdem::State& all, const Flag* comes) {
  const SurfaceSet& g = given_of<Surface>(m);
  for_each_faces(g, state_of<Surface>(all), [&](const SurfaceFaces& faces, SurfacePoints& points) {
    const Begin begin(all, g, faces, points);
    for (Index f = 0; f < faces.count; ++f)
      if (comes[begin.node(f, 0)]) begin(f);
  });
}

void Surface::act(const Model& m, cdem::State& all, Queue q) {
  const SurfaceSet& g = given_of<Surface>(m);
  if (!is_there(g)) return;
  const PhaseTimer timer(all, Phase::element);
  evaluate(m, all);
  SurfaceState& s = state_of<Surface>(all);
  act_on<3>(all, q, g, g.triangles, s.triangles);
  act_on<4>(all, q, g, g.quads, s.quads);
}

}  // namespace cdem
