// health.cpp - see health.hpp.
#include "core/diagnostics/health.hpp"

#include <cmath>

#include "core/base/primitives.hpp"
#include "core/diagnostics/node_health.hpp"
#include "core/ranks/ranks.hpp"

namespace cdem {

namespace {

/// The fastest node, its speed where that is not finite, and an exposed face with a lost contact:
/// on a rank its number among all faces of the whole model.
struct Suspects {
  Most fastest, lost;
  Real speed = 0;
};

Suspects of_ranks(const State& s, const Suspects& own) {
  Suspects all;
  for (const Suspects& one : of_all_ranks(s, own)) {
    const Index before = all.fastest.item;
    all.fastest.meet(one.fastest.value, one.fastest.item);
    if (all.fastest.item != before) all.speed = one.speed;
    all.lost.meet(one.lost.value, one.lost.item);
  }
  return all;
}

}  // namespace

Report check_health(const Model& m, const State& s) {
  const bool scaled = s.nodes.relax_mass.size() > 0;
  const SquaredSpeed squared_speed{.motion = s.nodes.motion.data(),
                                   .relax_mass = scaled ? s.nodes.relax_mass.data() : nullptr,
                                   .mass = m.mass.data()};
  Answer<Most> speed, loss;  // asked together
  find_most({}, m.node_count, squared_speed, s.share.counted("nodes").own, speed);
  find_most({}, Index(s.search.exposed_face.size()),
            LostContact{s.edges.lost.data(), s.springs.lost.data()}, s.share.counted("exposed").own,
            loss);
  Suspects own{.fastest = speed.read({}), .lost = loss.read({})};
  {
    const Transfer transfer;  // of one node, and of one face
    if (std::isinf(own.fastest.value) && own.fastest.item >= 0)
      own.speed = on_host(squared_speed).of(own.fastest.item);
    own.fastest.item = whole_node(s, own.fastest.item);
    if (s.share.exchange && own.lost.item >= 0)
      own.lost.item = whole_face(s, on_host(s.search.exposed_face)[own.lost.item]);
  }
  const Suspects all = of_ranks(s, own);
  const Most &fastest = all.fastest, &lost = all.lost;
  if (std::isinf(fastest.value) && fastest.item >= 0)
    return {Outcome::not_finite, fastest.item, all.speed};
  if (m.speed_limit > 0 && std::sqrt(fastest.value) > m.speed_limit)
    return {Outcome::too_fast, fastest.item, std::sqrt(fastest.value)};
  if (lost.value > 0) return {Outcome::lost_contact, lost.item, 0};
  return {};
}

}  // namespace cdem
