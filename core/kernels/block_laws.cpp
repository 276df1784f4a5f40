// block_laws.cpp - response of block laws to trial stresses at the points of elements, instantiated
// once for the kernels of all other files.
#include "core/elements/corotational.hpp"
#include "core/materials/flow_by.hpp"

namespace cdem {

#if !defined(__CUDACC__)
namespace {

template <class I>
void instantiate() {
  using T = Number<I>;
  BlockLaws::for_each([]<template <class> class Law, Index>() {
    if constexpr (Law<T>::inelastic) {
      [[maybe_unused]] const auto volatile at =
          &flow_by<Law, T, typename IndexOf<I>::type, StateRows<I>>;
    }
  });
}

}  // namespace

/// No one calls it.
void instantiate_block_laws() {
  instantiate<One>();
  instantiate<Lane>();
}
#endif

}  // namespace cdem
