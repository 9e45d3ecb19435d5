// Memory for a large array, not initialised. Large ones are pages of their own: huge ones where the system has them,
// since what is touched once per sweep would cost as much in small pages as in work; and given back at once, so that
// the peak of a computation is what it holds and not what an allocator keeps. Throws std::bad_alloc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace stormfield {

struct ReleasePages {
  std::size_t mapped = 0;  ///< bytes of pages of its own, 0 for allocated memory

  void operator()(void* p) const {
#ifdef __linux__
    if (mapped) {
      munmap(p, mapped);
      return;
    }
#endif
    ::operator delete(p, kAlignment);
  }

  /// Of memory that is no pages of its own: a cache line.
  static constexpr std::align_val_t kAlignment{64};
};

class Pages {
 public:
  Pages() = default;
  explicit Pages(std::size_t bytes) : bytes_(bytes) {
#ifdef __linux__
    if (bytes >= kHugePage) {
      data_ = Data(mapped(bytes), ReleasePages{bytes});
      return;
    }
#endif
    data_ = Data(::operator new((bytes / kLine + 1) * kLine, ReleasePages::kAlignment), ReleasePages{});
  }

  void* data() const {
    return data_.get();
  }
  std::size_t bytes() const {
    return data_ ? bytes_ : 0;
  }

 private:
  static constexpr std::size_t kLine = static_cast<std::size_t>(ReleasePages::kAlignment);
  static constexpr std::size_t kHugePage = std::size_t{1} << 21;

#ifdef __linux__
  /// Pages from the start of a huge one: before and after it there would be hundreds of small ones.
  static void* mapped(std::size_t bytes) {
    const std::size_t all = bytes + kHugePage;
    void* const found = mmap(nullptr, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (found == MAP_FAILED) throw std::bad_alloc();
    const auto first = reinterpret_cast<std::uintptr_t>(found);
    const std::size_t before = (kHugePage - first % kHugePage) % kHugePage;
    std::byte* const pages = static_cast<std::byte*>(found) + before;
    if (before) munmap(found, before);
    const auto small = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t used = (bytes + small - 1) / small * small;
    munmap(pages + used, all - before - used);
    madvise(pages, bytes, MADV_HUGEPAGE);
    return pages;
  }
#endif

  using Data = std::unique_ptr<void, ReleasePages>;
  std::size_t bytes_ = 0;
  Data data_;
};

}  // namespace stormfield
