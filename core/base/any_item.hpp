// any_item.hpp - does a kernel hold for any item?
#pragma once

#include "core/base/device.hpp"
#include "core/base/lanes.hpp"

namespace cdem {

/// Raise a flag, which is of an Answer, if `kernel(item)` holds for any of `count` items. A CPU
/// asks `kernel.quicker()` first, if there is that: a kernel that holds wherever this one does.
/// Instantiated in core/kernels.
template <class Kernel>
void raise_if_any(Queue queue, Index count, const Kernel& kernel, Flag* flag);

/// Does it hold for any? Waits for the answer.
template <class Kernel>
bool any_item(Queue queue, Index count, const Kernel& kernel);

}  // namespace cdem
