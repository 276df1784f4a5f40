// machine_limits.hpp - measures bandwidth and peak arithmetic of the machine, for benchmarks.
#pragma once

#include <cstddef>

namespace cdem {

/// Memory bandwidth of a triad a = b + s c over arrays of `bytes` together, all threads  [B/s].
/// Counts two reads and one write; that a write also reads its line first is not counted.
double measure_bandwidth(std::size_t bytes);

/// Peak rate of fused multiply-adds, all threads, two operations each  [flop/s].
double measure_flops();

}  // namespace cdem
