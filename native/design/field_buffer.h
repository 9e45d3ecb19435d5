// A large array of floats, not initialised, on huge pages where the system has them: a solve touches each of its few
// buffers once per sweep, and page faults would cost as much as a sweep.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace stormfield {

class FieldBuffer {
 public:
  FieldBuffer() = default;
  explicit FieldBuffer(std::size_t floats) : size_(floats) {
    constexpr std::size_t kPage = std::size_t{1} << 21;
    const std::size_t bytes = floats * sizeof(float);
    const std::size_t alignment = bytes >= kPage ? kPage : 64;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    data_.reset(static_cast<float*>(std::aligned_alloc(alignment, rounded ? rounded : alignment)));
    if (!data_) throw std::bad_alloc();
#ifdef __linux__
    if (bytes >= kPage) madvise(data_.get(), rounded, MADV_HUGEPAGE);
#endif
  }

  float* data() {
    return data_.get();
  }
  const float* data() const {
    return data_.get();
  }
  std::size_t size() const {
    return size_;
  }
  void release() {
    *this = FieldBuffer();
  }

 private:
  struct Free {
    void operator()(float* p) const { std::free(p); }
  };
  std::size_t size_ = 0;
  std::unique_ptr<float[], Free> data_;
};

}  // namespace stormfield
