// curves.cpp - see curves.hpp.
#include "core/nodes/curves.hpp"

#include <algorithm>

namespace cdem {

namespace {

/// Factors of all curves at one time; piecewise linear, constant outside.
void evaluate_at(const Model& m, Real time, Column<Real>& values) {
  values.renew(m.curve_time.size());
  const auto factors = on_host(values);
  for (std::size_t c = 0; c < m.curve_time.size(); ++c) {
    const auto& t = m.curve_time[c];
    const auto& f = m.curve_factor[c];
    const std::size_t after = std::upper_bound(t.begin(), t.end(), time) - t.begin();
    if (after == 0) {
      factors[c] = f.front();
    } else if (after == t.size()) {
      factors[c] = f.back();
    } else {
      const Real part = (time - t[after - 1]) / (t[after] - t[after - 1]);
      factors[c] = f[after - 1] + part * (f[after] - f[after - 1]);
    }
  }
}

}  // namespace

void set_loads_and_supports(const Model& m, State& s) {
  const Transfer transfer;
  evaluate_at(m, s.time, s.load_factor);
  s.relief.part = s.relief.at(s.time);
  evaluate_at(m, s.time + 0.5 * s.dt, s.velocity_factor);
}

}  // namespace cdem
