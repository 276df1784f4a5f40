// curves.cpp - see curves.hpp.
#include "core/nodes/curves.hpp"

#include <algorithm>
#include <utility>

namespace cdem {

namespace {

/// Factor of a curve at one time; piecewise linear, constant outside.
Real factor_at(const std::vector<Real>& times, const std::vector<Real>& factors, Real time) {
  const std::size_t after = std::upper_bound(times.begin(), times.end(), time) - times.begin();
  if (after == 0) return factors.front();
  if (after == times.size()) return factors.back();
  const Real part = (time - times[after - 1]) / (times[after] - times[after - 1]);
  return factors[after - 1] + part * (factors[after] - factors[after - 1]);
}

/// Factors of all curves at one time; written only where they are others than before.
void evaluate_at(const Model& m, Real time, std::vector<Real>& known, Column<Real>& values) {
  bool changes = known.size() != m.curve_time.size();
  known.resize(m.curve_time.size());
  for (std::size_t c = 0; c < known.size(); ++c) {
    const Real before =
        std::exchange(known[c], factor_at(m.curve_time[c], m.curve_factor[c], time));
    changes = changes || known[c] != before;
  }
  if (!changes) return;
  const Transfer transfer;
  values.assign(known);
}

}  // namespace

void find_loads_and_supports(const Model& m, State& s) {
  evaluate_at(m, s.loads_time, s.known_load_factor, s.load_factor);
  s.relief.part = s.relief.at(s.loads_time);
  evaluate_at(m, s.loads_time + 0.5 * s.dt, s.known_velocity_factor, s.velocity_factor);
}

void set_loads_and_supports(const Model& m, State& s) {
  s.loads_time = s.time;
  find_loads_and_supports(m, s);
}

}  // namespace cdem
