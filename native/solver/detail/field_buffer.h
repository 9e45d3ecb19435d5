// A large array of floats, not initialised (base/pages.h).
#pragma once

#include "base/pages.h"

namespace stormfield {

class FieldBuffer {
 public:
  FieldBuffer() = default;
  explicit FieldBuffer(std::size_t floats) : size_(floats), pages_(floats * sizeof(float)) {}

  float* data() { return static_cast<float*>(pages_.data()); }
  const float* data() const { return static_cast<const float*>(pages_.data()); }
  std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
  Pages pages_;
};

}  // namespace stormfield
