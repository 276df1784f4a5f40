// device.cpp - see device.hpp. Compiled as C++, and as CUDA for the CUDA module.
#include "core/base/device.hpp"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

#include "core/base/lanes.hpp"
#include "core/base/openmp.hpp"
#include "core/base/spare_memory.hpp"

namespace cdem {
inline namespace CDEM_DEVICE {

#if defined(CDEM_CUDA)

void check(cudaError_t error) {
  if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}
namespace {

struct ManagedMemory {
  static void* take(std::size_t bytes) {
    void* memory = nullptr;
    if (cudaMallocManaged(&memory, bytes) == cudaSuccess) return memory;
    cudaGetLastError();  // it is dealt with
    return nullptr;
  }
  static void give(void* memory) { cudaFree(memory); }
};
/// Never released: the device may be gone by then.
SpareMemory<ManagedMemory>& managed_memory() {
  static auto& memory = *new SpareMemory<ManagedMemory>;
  return memory;
}

}  // namespace

void* allocate(std::size_t bytes) {
  void* const memory = managed_memory().take(bytes);
  check(cudaMemsetAsync(memory, 0, bytes, nullptr));  // after launches that still use it
  return memory;
}
void release(void* memory) {
  if (memory) managed_memory().give(memory);
}
void* allocate_answer(std::size_t bytes) {
  void* memory = nullptr;
  check(cudaHostAlloc(&memory, bytes, cudaHostAllocMapped));
  std::memset(memory, 0, bytes);
  return memory;
}
bool runs_alone() { return false; }
void finish(Queue queue) { check(cudaStreamSynchronize(static_cast<cudaStream_t>(queue.stream))); }
const char* device_name() {
  static cudaDeviceProp properties;
  check(cudaGetDeviceProperties(&properties, 0));
  return properties.name;
}

#elif defined(CDEM_CPU)

namespace {

/// Before each block: its length, with this.
constexpr std::size_t header = 64;
/// From here on memory comes from the system, in pages of zeros, and goes back there at once. The C
/// library would keep it: a rebuild of the pair list leaves a quarter of the memory of a process
/// so.
constexpr std::size_t large = std::size_t(1) << 20;

}  // namespace

void* allocate(std::size_t bytes) {
  const std::size_t whole = header + (bytes + 63) / 64 * 64;
  void* memory = nullptr;
  if (whole >= large) {
    memory = mmap(nullptr, whole, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
  } else {
    memory = std::aligned_alloc(64, whole);
    if (!memory) throw std::bad_alloc();
    std::memset(memory, 0, whole);
  }
  *static_cast<std::size_t*>(memory) = whole;
  return static_cast<char*>(memory) + header;
}
void release(void* memory) {
  if (!memory) return;
  void* const block = static_cast<char*>(memory) - header;
  const std::size_t whole = *static_cast<std::size_t*>(block);
  if (whole >= large)
    munmap(block, whole);
  else
    std::free(block);
}
void* allocate_answer(std::size_t bytes) { return allocate(bytes); }
bool runs_alone() { return omp_get_max_threads() == 1; }
void finish(Queue) {}
const char* device_name() { return "cpu"; }

#endif

}  // namespace CDEM_DEVICE
}  // namespace cdem
