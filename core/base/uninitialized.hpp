// uninitialized.hpp - vectors for loops to fill.
#pragma once

#include <memory>
#include <vector>

namespace cdem {

/// A vector for loops to fill: its items begin uninitialised. To fill them twice, the first time on
/// one thread, would cost as much as the loops do.
template <class T>
struct LeaveUnset : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LeaveUnset<U>;
  };
  void construct(T* item) { ::new (static_cast<void*>(item)) T; }
};
template <class T>
using Unset = std::vector<T, LeaveUnset<T>>;

}  // namespace cdem
