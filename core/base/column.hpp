// column.hpp - owned, padded arrays.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/device.hpp"
#include "core/base/lanes.hpp"

namespace cdem {

/// Owned array in the memory of the device, that grows without losing content. Kernels have it by
/// `data`, host code by `on_host`. Padded, so a lane may read past the last item.
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
    if (size > size_) {
      if (size > capacity_) reserve(grown(size));
      wait_for_launches();
      for (std::size_t i = size_; i < size; ++i) data_[i] = fill;
    }
    size_ = size;
  }
  /// Set the length and forget the items: for kernels to write all of them.
  void renew(std::size_t size) {
    if (size > capacity_) {
      Column().swap(*this);
      take(spare ? size + size / 8 : size);  // the next time it may be a little longer
    }
    size_ = size;
  }
  /// Take the array that the host has made.
  void assign(const T* from, std::size_t size) {
    if (from == data_) return resize(size);  // its own view
    renew(size);
    wait_for_launches();
    if (size) std::memcpy(data_, from, size * sizeof(T));
  }
  void assign(const std::vector<T>& from) { assign(from.data(), from.size()); }
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  void swap(Column& other) {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  // The emulated device tells of items past the end.
#if defined(CDEM_EMULATED)
  static constexpr bool spare = false;
#else
  static constexpr bool spare = true;
#endif
  std::size_t grown(std::size_t size) const {
    return size > 2 * capacity_ || !spare ? size : 2 * capacity_;
  }
  void take(std::size_t capacity) {
    data_ = static_cast<T*>(allocate((capacity + (spare ? 16 : 0)) * sizeof(T)));
    capacity_ = capacity;
  }
  void reserve(std::size_t capacity) {
    const Column before(std::move(*this));
    take(capacity);
    size_ = before.size_;
    wait_for_launches();
    if (size_) std::memcpy(data_, before.data_, size_ * sizeof(T));
  }
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Items of an array in the hands of host code, until the next launch or until the array grows.
template <class T>
class OnHost {
 public:
  OnHost(T* items, std::size_t size) : items_(items), size_(size) {}
  T& operator[](std::size_t i) const { return items_[i]; }
  T* begin() const { return items_; }
  T* end() const { return items_ + size_; }
  T* data() const { return items_; }
  std::size_t size() const { return size_; }

 private:
  T* items_;
  std::size_t size_;
};

/// Give an array to host code. All launched kernels have then finished.
template <class T>
OnHost<T> on_host(Column<T>& column) {
  wait_for_launches();
  return {column.data(), column.size()};
}
template <class T>
OnHost<const T> on_host(const Column<T>& column) {
  wait_for_launches();
  return {column.data(), column.size()};
}
/// The same with a view of arrays that kernels have, too.
template <class View>
  requires std::is_trivially_copyable_v<View>
View on_host(const View& view) {
  wait_for_launches();
  return view;
}

/// The numbers of an array, being copied to the host.
template <class T>
std::vector<T> fetch(const Column<T>& column) {
  const Transfer transfer;
  const auto items = on_host(column);
  return {items.begin(), items.end()};
}

/// Rows of several numbers per item, stored row after row: number r of item i is data[r*stride +
/// i]. The stride avoids multiples of 4096 bytes, at which all rows fall into one cache set.
inline Index padded_stride(Index count) {
  const Index whole = (count + 7) / 8 * 8;
  return whole % 512 == 0 ? whole + 8 : whole;
}

}  // namespace cdem
