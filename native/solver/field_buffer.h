// A large array of floats, not initialised. Large ones are pages of their own: huge ones where the system has them,
// since a solve touches its few vectors once per sweep and small pages would cost as much as a sweep; and given back at
// once, so that the peak of a solve is what it holds and not what an allocator keeps.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace stormfield {

struct FreeFloats {
  std::size_t mapped = 0;  ///< bytes of pages of its own, 0 for allocated memory

  void operator()(float* p) const {
#ifdef __linux__
    if (mapped) {
      munmap(p, mapped);
      return;
    }
#endif
    std::free(p);
  }
};

class FieldBuffer {
 public:
  FieldBuffer() = default;
  explicit FieldBuffer(std::size_t floats) : size_(floats) {
    const std::size_t bytes = floats * sizeof(float);
#ifdef __linux__
    constexpr std::size_t kHugePage = std::size_t{1} << 21;
    if (bytes >= kHugePage) {
      void* pages = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (pages == MAP_FAILED) throw std::bad_alloc();
      madvise(pages, bytes, MADV_HUGEPAGE);
      data_ = Data(static_cast<float*>(pages), FreeFloats{bytes});
      return;
    }
#endif
    data_ = Data(static_cast<float*>(std::aligned_alloc(64, (bytes / 64 + 1) * 64)));
    if (!data_) throw std::bad_alloc();
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

 private:
  using Data = std::unique_ptr<float[], FreeFloats>;
  std::size_t size_ = 0;
  Data data_;
};

}  // namespace stormfield
