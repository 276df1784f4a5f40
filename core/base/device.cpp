// device.cpp - see device.hpp. Compiled as C++, and as CUDA for the CUDA module.
#include "core/base/device.hpp"

#include <omp.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

namespace cdem {

#if defined(__CUDACC__)

void* allocate(std::size_t bytes) {
  void* memory = nullptr;
  if (cudaMallocManaged(&memory, bytes) != cudaSuccess) throw std::bad_alloc();
  std::memset(memory, 0, bytes);
  return memory;
}
void release(void* memory) { cudaFree(memory); }
bool runs_alone() { return false; }
void finish(Queue queue) {
  const cudaError_t error = cudaStreamSynchronize(queue.stream);
  if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}
const char* device_name() {
  static cudaDeviceProp properties;
  if (cudaGetDeviceProperties(&properties, 0) != cudaSuccess)
    throw std::runtime_error("no CUDA device that works was found");
  return properties.name;
}

#else

void* allocate(std::size_t bytes) {
  const std::size_t whole = (bytes + 63) / 64 * 64;
  void* memory = std::aligned_alloc(64, whole);
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, whole);
  return memory;
}
void release(void* memory) { std::free(memory); }
bool runs_alone() { return omp_get_max_threads() == 1; }
void finish(Queue) {}
const char* device_name() { return "cpu"; }

#endif

}  // namespace cdem
