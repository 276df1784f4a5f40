// answer.hpp - values that kernels write and the host reads.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "core/base/device.hpp"

namespace cdem {

/// Memory of answers that nobody uses. It is never released: the device may be gone by then.
class SpareAnswers {
 public:
  static constexpr std::size_t size = 64;

  void* take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (spare_.empty()) return allocate_answer(size);
    void* const memory = spare_.back();
    spare_.pop_back();
    return memory;
  }
  void give(void* memory) {
    const std::lock_guard<std::mutex> lock(mutex_);
    spare_.push_back(memory);
  }
  static SpareAnswers& all() {
    static auto& spare = *new SpareAnswers;
    return spare;
  }

 private:
  std::mutex mutex_;
  std::vector<void*> spare_;
};

/// A value that kernels write and the host reads with one wait, whatever else is asked meanwhile.
template <class T>
class Answer {
 public:
  static_assert(sizeof(T) <= SpareAnswers::size);

  Answer() = default;
  Answer(Answer&& other) noexcept
      : value_(std::exchange(other.value_, nullptr)), asked_(other.asked_) {}
  Answer& operator=(Answer&& other) noexcept {
    std::swap(value_, other.value_);
    std::swap(asked_, other.asked_);
    return *this;
  }
  ~Answer() {
    if (value_) SpareAnswers::all().give(value_);
  }

  /// Set it before kernels are asked. Waits for those that are asked already.
  void set(Queue queue, const T& value) {
    T* const own = place();
    if (asked_) finish(queue);
    const Transfer transfer;
    *own = value;
  }
  /// The place that kernels write to.
  T* data() {
    asked_ = true;
    return place();
  }
  /// Waits for all that is asked.
  T read(Queue queue) {
    finish(queue);
    asked_ = false;
    const Transfer transfer;
    return *place();
  }

 private:
  T* place() {
    if (!value_) value_ = static_cast<T*>(SpareAnswers::all().take());
    return value_;
  }

  T* value_ = nullptr;
  bool asked_ = false;
};

/// One of a thread for functions that ask and read at once.
template <class T>
Answer<T>& answer_of_thread() {
  static thread_local Answer<T> answer;
  return answer;
}

}  // namespace cdem
