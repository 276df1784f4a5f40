// prefetch.hpp - ask for memory ahead of the loop that will use it.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// How a kernel prefetches data.
struct Fetching {
  Index ahead;  // so many blocks
  Index worth;  // if there are as many blocks; fewer leave it in the caches from step to step
};
/// Ask for memory that will be read soon.
CDEM_HD inline void fetch(const void* memory) {
#if !defined(__CUDA_ARCH__)
  __builtin_prefetch(memory);
#endif
}

}  // namespace cdem
