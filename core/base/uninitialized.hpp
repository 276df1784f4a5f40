// uninitialized.hpp - vectors for loops to fill.
#pragma once

#include <memory>
#include <vector>

namespace cdem {

/// A vector for loops to fill: its items begin as the memory is, for to fill them twice, at first
/// on one thread, costs as much as what the loops do.
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
