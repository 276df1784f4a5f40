// any_item.hpp - does a kernel hold for any item?
#pragma once

#include "core/base/device.hpp"
#include "core/base/lanes.hpp"

namespace cdem {

/// Does `kernel(item)` hold for any of `count` items? Waits for the answer, which is one word on
/// its way to the host. Instantiated in core/kernels.
template <class Kernel>
bool any_item(Queue queue, Index count, const Kernel& kernel);

}  // namespace cdem
