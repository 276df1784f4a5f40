// sorted.hpp - find a number among ascending ones.
#pragma once

#include "core/base/lanes.hpp"

namespace cdem {

/// Place of the first of `count` ascending numbers that is not below `number`, or `count`. Not
/// std::lower_bound, whose steps CUDA 13 leaves out in a kernel, without a word.
template <class T>
CDEM_HD inline Index first_from(const T* numbers, Index count, T number) {
  Index low = 0, high = count;
  while (low < high) {
    const Index middle = low + (high - low) / 2;
    if (numbers[middle] < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Is a number among them?
template <class T>
CDEM_HD inline bool is_among(const T* numbers, Index count, T number) {
  const Index place = first_from(numbers, count, number);
  return place < count && numbers[place] == number;
}

}  // namespace cdem
