// device.hpp - the machine under the kernels: its memory, its queue, its name.
#pragma once

#include <cstddef>

#include "core/base/lanes.hpp"

namespace cdem {

/// Where launches are put: a CUDA stream, or nothing on the CPU.
struct Queue {
#if defined(__CUDACC__)
  cudaStream_t stream = nullptr;
#else
  void* stream = nullptr;
#endif
};

/// Zeroed, 64-byte aligned memory that the kernels can reach (managed memory on CUDA).
void* allocate(std::size_t bytes);
void release(void* memory);

/// Wait until all launches are done; host code may read their columns then.
void finish(Queue queue);

/// Is there one thread for all items of a loop?
bool runs_alone();

/// "cpu", or the name of the GPU; throws std::runtime_error when there is none.
const char* device_name();

}  // namespace cdem
