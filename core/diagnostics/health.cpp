// health.cpp - see health.hpp.
#include "core/diagnostics/health.hpp"

#include <cmath>

#include "core/base/primitives.hpp"
#include "core/diagnostics/node_health.hpp"

namespace cdem {

Report check_health(const Model& m, const State& s) {
  const bool scaled = s.nodes.relax_mass.size() > 0;
  const SquaredSpeed squared_speed{.motion = s.nodes.motion.data(),
                                   .relax_mass = scaled ? s.nodes.relax_mass.data() : nullptr,
                                   .mass = m.mass.data()};
  Answer<Most> speed, loss;  // asked together
  find_most({}, m.node_count, squared_speed, speed);
  find_most({}, Index(s.search.exposed_face.size()),
            LostContact{s.edges.lost.data(), s.springs.lost.data()}, loss);
  const Most fastest = speed.read({}), lost = loss.read({});
  if (std::isinf(fastest.value) && fastest.item >= 0) {
    const Transfer transfer;  // of one node
    return {Outcome::not_finite, fastest.item, on_host(squared_speed).of(fastest.item)};
  }
  if (m.speed_limit > 0 && std::sqrt(fastest.value) > m.speed_limit)
    return {Outcome::too_fast, fastest.item, std::sqrt(fastest.value)};
  if (lost.value > 0) return {Outcome::lost_contact, lost.item, 0};
  return {};
}

}  // namespace cdem
