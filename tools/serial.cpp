// serial.cpp - a clock of what stands outside of the parallel loops, put before OpenMP by
// serial.py.
#include <dlfcn.h>

#include <chrono>

namespace {

struct Clock {
  double outside = 0, inside = 0;  // [s]
  long regions = 0;
  double since = 0;
};
Clock clock_of;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using Parallel = void (*)(void (*)(void*), void*, unsigned, unsigned);
Parallel openmp() {
  return reinterpret_cast<Parallel>(dlsym(dlopen("libgomp.so.1", RTLD_NOW), "GOMP_parallel"));
}

}  // namespace

extern "C" {

/// Called by the compiled code for each parallel region; `threads` is 1 where it is not worth any.
void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags) {
  static const Parallel run = openmp();
  if (threads == 1) return run(body, data, threads, flags);
  const double begin = now();
  run(body, data, threads, flags);
  const double end = now();
  clock_of.outside += begin - clock_of.since;
  clock_of.inside += end - begin;
  clock_of.since = end;
  ++clock_of.regions;
}

void begin_serial() { clock_of = {.since = now()}; }
/// Seconds outside and inside of parallel regions, and how many these were.
void end_serial(double* seconds, long* regions) {
  seconds[0] = clock_of.outside + now() - clock_of.since;
  seconds[1] = clock_of.inside;
  *regions = clock_of.regions;
}
}
