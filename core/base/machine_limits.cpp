// machine_limits.cpp - see machine_limits.hpp.
#include "core/base/machine_limits.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/base/column.hpp"
#include "core/base/lanes.hpp"
#include "core/base/openmp.hpp"

namespace cdem {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

double measure_bandwidth(std::size_t bytes) {
  const std::size_t n = bytes / (3 * sizeof(Real));
  std::vector<Real> a(n), b(n), c(n);
  double best = 0;
  for (int round = 0; round < 6; ++round) {  // the first one maps the pages
    const double start = seconds_now();
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
    const double seconds = seconds_now() - start;
    if (round > 0) best = std::max(best, double(bytes) / seconds);
    b[round] = a[n / 2];  // so that no round can be left out
  }
  return best;
}

double measure_flops() {
  constexpr int width = 12 * lanes, rounds = 200000;  // twelve registers hide the latency
  double best = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    Real sum = 0;
    const double start = seconds_now();
#pragma omp parallel reduction(+ : sum)
    {
      Real acc[width];
      for (int j = 0; j < width; ++j) acc[j] = j;
      for (int r = 0; r < rounds; ++r)
        for (int j = 0; j < width; ++j) acc[j] = std::fma(acc[j], 0.999999, 1e-6);
      for (int j = 0; j < width; ++j) sum += acc[j];
    }
    const double seconds = seconds_now() - start;
    if (sum > 0)  // always; the compiler must not know
      best = std::max(best, 2.0 * width * rounds * omp_get_max_threads() / seconds);
  }
  return best;
}

}  // namespace cdem
