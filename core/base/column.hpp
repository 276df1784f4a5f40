// column.hpp - owned, padded arrays.
#pragma once

#include <cstddef>
#include <cstring>
#include <utility>

#include "core/base/device.hpp"

namespace cdem {

/// Owned array that grows without losing content. Padded, so a lane may read past the last item.
template <class T>
class Column {
 public:
  Column() = default;
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;
  Column(Column&& other) noexcept { swap(other); }
  Column& operator=(Column&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Column() { release(data_); }

  /// Set the length; items that are new are `fill`.
  void resize(std::size_t size, T fill = T{}) {
    if (size > capacity_) reserve(size > 2 * capacity_ ? size : 2 * capacity_);
    for (std::size_t i = size_; i < size; ++i) data_[i] = fill;
    size_ = size;
  }
  void assign(const T* from, std::size_t size) {
    resize(size);
    if (size && from != data_) std::memcpy(data_, from, size * sizeof(T));  // may be its own view
  }
  void fill(T value) {
    for (std::size_t i = 0; i < size_; ++i) data_[i] = value;
  }
  void push(T value) {
    resize(size_ + 1);
    data_[size_ - 1] = value;
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  void swap(Column& other) {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  void reserve(std::size_t capacity) {
    T* memory = static_cast<T*>(allocate((capacity + 16) * sizeof(T)));
    if (size_) std::memcpy(memory, data_, size_ * sizeof(T));
    release(data_);
    data_ = memory;
    capacity_ = capacity;
  }
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Rows of several numbers per item, stored row after row: number r of item i is data[r*stride +
/// i]. The stride avoids multiples of 4096 bytes, at which all rows fall into one cache set.
inline Index padded_stride(Index count) {
  const Index whole = (count + 7) / 8 * 8;
  return whole % 512 == 0 ? whole + 8 : whole;
}

}  // namespace cdem
