// openmp.hpp - OpenMP; where the compiler has none, what the core asks of it: there is one thread.
#pragma once

#if defined(_OPENMP)
#include <omp.h>
inline constexpr bool with_openmp = true;
#else
inline constexpr bool with_openmp = false;
inline int omp_get_max_threads() { return 1; }
inline int omp_get_num_threads() { return 1; }
inline int omp_get_thread_num() { return 0; }
inline void omp_set_num_threads(int) {}
#endif
