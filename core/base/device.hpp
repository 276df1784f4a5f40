// device.hpp - the machine under the kernels: its memory, its queue, its name.
#pragma once

#include <cstddef>

#if defined(__CUDACC__)
#include <cuda_runtime.h>
#endif

// Device of a core; a mix does not link, since the device is part of the names of symbols.
#if defined(CDEM_CUDA)
#define CDEM_DEVICE cuda
#elif defined(CDEM_EMULATED)
#define CDEM_DEVICE emulated
#else
#define CDEM_CPU
#define CDEM_DEVICE cpu
#endif

namespace cdem {
inline namespace CDEM_DEVICE {

/// Do kernels run on a GPU?
#if defined(CDEM_CUDA)
inline constexpr bool on_gpu = true;
#else
inline constexpr bool on_gpu = false;
#endif

/// Where launches are put: a CUDA stream, or nothing on the CPU.
struct Queue {
  void* stream = nullptr;
};

/// Zeroed, 64-byte aligned memory that the kernels can reach (managed memory on CUDA, an arena of
/// emulated.hpp).
void* allocate(std::size_t bytes);
/// Give memory back. Launches that are already put may still use it, and later ones may take it
/// again.
void release(void* memory);

/// Zeroed memory of a few words that kernels set and the host reads: on CUDA it is the host's, for
/// pages that both touch travel. It is never released.
void* allocate_answer(std::size_t bytes);

/// Wait until all launches are done; host code may read their columns then.
void finish(Queue queue);
/// The same for host code that is about to touch arrays; a launch on the CPU ends with its work.
inline void wait_for_launches() {
#if !defined(CDEM_CPU)
  finish({});
#endif
}

/// While one lives the arrays are the device's: the host touches them in a Transfer, which is
/// waited for and told of. The emulated device finds where it does not; others take no notice.
struct RunOnDevice {
#if defined(CDEM_EMULATED)
  RunOnDevice();
  ~RunOnDevice();
#else
  RunOnDevice() {}
#endif
};
/// While one lives host code may touch arrays in a run.
struct Transfer {
#if defined(CDEM_EMULATED)
  Transfer();
  ~Transfer();
#else
  Transfer() {}
#endif
};

/// Is there one thread for all items of a loop?
bool runs_alone();

/// "cpu", "emulated", or the name of the GPU; throws std::runtime_error when there is none.
const char* device_name();

#if defined(__CUDACC__)
/// Throw std::runtime_error with the words of CUDA, if this is an error.
void check(cudaError_t error);
#endif

}  // namespace CDEM_DEVICE
}  // namespace cdem
