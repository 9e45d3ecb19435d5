// The vectors of a field at all its samples of lambda: an array of a fixed size in pages of its own (base/pages.h),
// which may come from whoever made the field, so that they need not be found, cleared and given back once more.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "base/pages.h"
#include "base/types.h"

namespace stormfield {

class FieldValues {
 public:
  FieldValues() = default;
  /// Zeros.
  explicit FieldValues(std::size_t size) : FieldValues(size, Pages()) { std::fill(begin(), end(), Complex()); }
  /// Not initialised, in these pages or, where they are too small, in new ones.
  FieldValues(std::size_t size, Pages pages)
      : size_(size),
        pages_(pages.bytes() >= size * sizeof(Complex) ? std::move(pages) : Pages(size * sizeof(Complex))) {}
  FieldValues(const std::vector<Complex>& values) : FieldValues(values.size(), Pages()) {
    std::copy(values.begin(), values.end(), begin());
  }

  FieldValues(const FieldValues& other) : FieldValues(other.size(), Pages()) {
    std::copy(other.begin(), other.end(), begin());
  }
  FieldValues(FieldValues&& other) noexcept : size_(std::exchange(other.size_, 0)), pages_(std::move(other.pages_)) {}
  FieldValues& operator=(FieldValues other) noexcept {
    std::swap(size_, other.size_);
    std::swap(pages_, other.pages_);
    return *this;
  }
  ~FieldValues() = default;

  std::size_t size() const { return size_; }
  Complex* data() { return static_cast<Complex*>(pages_.data()); }
  const Complex* data() const { return static_cast<const Complex*>(pages_.data()); }
  Complex* begin() { return data(); }
  const Complex* begin() const { return data(); }
  Complex* end() { return data() + size_; }
  const Complex* end() const { return data() + size_; }
  Complex& operator[](std::size_t k) { return data()[k]; }
  const Complex& operator[](std::size_t k) const { return data()[k]; }

  friend bool operator==(const FieldValues& a, const FieldValues& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::size_t size_ = 0;
  Pages pages_;
};

}  // namespace stormfield
