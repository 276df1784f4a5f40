// backend.cpp - the list of launches. backend.cu is this file again, given to the CUDA compiler.
#include "core/backend.hpp"

#include <omp.h>

#include <cstdlib>
#include <new>
#include <stdexcept>

#include "core/contact/bond.hpp"
#include "core/contact/close.hpp"
#include "core/contact/force.hpp"
#include "core/contact/gather.hpp"
#include "core/contact/target_edge.hpp"
#include "core/contact/target_face.hpp"
#include "core/elements/corotational.hpp"
#include "core/elements/incremental.hpp"
#include "core/nodes/free_block.hpp"

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

template <class Kernel>
void launch(Queue queue, Index count, const Kernel& kernel) {
  for_each(queue, count, kernel);
}
template <class Kernel>
void launch_one(Queue queue, Index count, const Kernel& kernel) {
  for_each_one(queue, count, kernel);
}
template <class Kernel>
void launch_picked(Queue queue, Index count, const Kernel& kernel) {
  for_each_picked(queue, count, kernel);
}
template <class Kernel>
void launch(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  for_each(queue, count, blocks, kernel);
}
template <class Kernel>
void launch_one(Queue queue, Index count, Blocks blocks, const Kernel& kernel) {
  for_each_one(queue, count, blocks, kernel);
}

template void launch(Queue, Index, Blocks, const CorotationalForce<Tet4, FollowRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Pyramid5, FollowRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Wedge6, FollowRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Hex8, FollowRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Hex8OnePoint, FollowRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Tet4, IgnoreRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Pyramid5, IgnoreRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Wedge6, IgnoreRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Hex8, IgnoreRotation>&);
template void launch(Queue, Index, Blocks, const CorotationalForce<Hex8OnePoint, IgnoreRotation>&);
template void launch(Queue, Index, const CorotationalReport<Tet4, FollowRotation>&);
template void launch(Queue, Index, const CorotationalReport<Pyramid5, FollowRotation>&);
template void launch(Queue, Index, const CorotationalReport<Wedge6, FollowRotation>&);
template void launch(Queue, Index, const CorotationalReport<Hex8, FollowRotation>&);
template void launch(Queue, Index, const CorotationalReport<Hex8OnePoint, FollowRotation>&);
template void launch(Queue, Index, const CorotationalReport<Tet4, IgnoreRotation>&);
template void launch(Queue, Index, const CorotationalReport<Pyramid5, IgnoreRotation>&);
template void launch(Queue, Index, const CorotationalReport<Wedge6, IgnoreRotation>&);
template void launch(Queue, Index, const CorotationalReport<Hex8, IgnoreRotation>&);
template void launch(Queue, Index, const CorotationalReport<Hex8OnePoint, IgnoreRotation>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Tet4, TurnByHalves>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Pyramid5, TurnByHalves>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Wedge6, TurnByHalves>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Hex8, TurnByHalves>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Hex8OnePoint, TurnByHalves>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Tet4, NeverTurn>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Pyramid5, NeverTurn>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Wedge6, NeverTurn>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Hex8, NeverTurn>&);
template void launch(Queue, Index, Blocks, const IncrementalForce<Hex8OnePoint, NeverTurn>&);
template void launch(Queue, Index, Blocks, const AdvanceFree<Tet4>&);
template void launch(Queue, Index, Blocks, const AdvanceFree<Hex8>&);
template void launch(Queue, Index, Blocks, const AdvanceFree<Hex8OnePoint>&);
template void launch(Queue, Index, Blocks, const ConformingBonds<3>&);
template void launch(Queue, Index, Blocks, const ConformingBonds<4>&);

template void launch_one(Queue, Index, Blocks, const OverlapBonds&);
template void launch_one(Queue, Index, const UpdateFaceGeometry&);
template void launch_one(Queue, Index, const MarkSharpSides&);
template void launch_picked(Queue, Index, const KeepTargetFaces&);
template void launch_picked(Queue, Index, const SiftTargetFaces&);
template void launch_one(Queue, Index, const FindTargetFaces&);
template void launch(Queue, Index, const SiftTargetEdges&);
template void launch_picked(Queue, Index, const TouchTargetEdges&);
template void launch_picked(Queue, Index, const UpdateSpringForces&);
template void launch(Queue, Index, const UpdateEdgeForces&);
template void launch_one(Queue, Index, const ListEdges&);
template void launch(Queue, Index, const MarkNearFaces&);
template void launch_picked(Queue, Index, const MarkCloseFaces&);
template void launch_one(Queue, Index, const CountCloseFaces&);
template void launch_one(Queue, Index, const ListCloseFaces&);
template void launch(Queue, Index, const MarkNearEdges&);
template void launch_one(Queue, Index, const MarkHeldEdges&);
template void launch_one(Queue, Index, const CopyCloseEdges&);
template void launch_one(Queue, Index, const CountActing&);
template void launch_one(Queue, Index, const ListActing&);
template void launch_one(Queue, Index, const GatherFaceForces&);
template void launch_one(Queue, Index, Blocks, const SumNodeForces&);
template void launch_one(Queue, Index, Blocks, const MoveNodes&);
template void launch_one(Queue, Index, Blocks, const AdvanceNodes&);
template void launch_one(Queue, Index, const NodeMomentum&);
template void launch_one(Queue, Index, const SampleNodes&);

}  // namespace cdem
