// backend.hpp - the machine under the kernels: memory and launches.
#pragma once

#include "core/launch.hpp"

namespace cdem {

/// Run a kernel for `count` items; straight-line kernels go lane by lane. Instantiated for every
/// kernel in backend.cpp, which is the list of launches.
template <class Kernel>
void launch(Queue queue, Index count, const Kernel& kernel);

/// The same for kernels whose items take different paths.
template <class Kernel>
void launch_one(Queue queue, Index count, const Kernel& kernel);

/// The same for kernels that pick what they run for: of the `items(row)` of each of `count` rows
/// those that it `picks(row, id)`. What is picked goes lane by lane.
template <class Kernel>
void launch_picked(Queue queue, Index count, const Kernel& kernel);

/// The same for some of the items.
template <class Kernel>
void launch(Queue queue, Index count, Blocks blocks, const Kernel& kernel);
template <class Kernel>
void launch_one(Queue queue, Index count, Blocks blocks, const Kernel& kernel);

/// Wait until all launches are done; host code may read their columns then.
void finish(Queue queue);

/// "cpu", or the name of the GPU; throws std::runtime_error when there is none.
const char* device_name();

}  // namespace cdem
