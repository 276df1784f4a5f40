// threads.cpp - see threads.hpp.
#include "core/base/threads.hpp"

#include "core/base/openmp.hpp"

namespace cdem {

void on_threads(bool several, void (*work)(const void* of, Thread thread), const void* of) {
  if (!several || omp_get_max_threads() == 1) {
    work(of, {0, 1});
    return;
  }
#pragma omp parallel
  work(of, {omp_get_thread_num(), omp_get_num_threads()});
}

}  // namespace cdem
