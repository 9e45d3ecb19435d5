# Compiler settings and dependencies of every target, in one place.
find_package(Eigen3 REQUIRED NO_MODULE)  # without a version: 5 does not count as compatible with 3.4, but is
if(Eigen3_VERSION VERSION_LESS 3.4)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old; install Eigen 3.4 or newer")
endif()
find_package(Threads REQUIRED)  # a static oneTBB asks for it and does not look itself
find_package(TBB REQUIRED)

add_library(stormfield_options INTERFACE)
target_compile_options(stormfield_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<BOOL:${STORMFIELD_WERROR}>:-Werror>)
# Kernels join conditions with & and | to do without branches; libstdc++'s own stable_sort calls what C++17 deprecates.
target_compile_options(stormfield_options INTERFACE
  $<$<CXX_COMPILER_ID:Clang>:-Wno-bitwise-instead-of-logical -Wno-deprecated-declarations>)
# std::complex products without the checks for infinities that the field never contains; products and sums rounded one
# by one on every processor and by every compiler.
target_compile_options(stormfield_options INTERFACE -fcx-limited-range -ffp-contract=off)
target_compile_options(stormfield_options INTERFACE $<$<CONFIG:Release>:-O3>)
if(STORMFIELD_SANITIZE)
  # Compiles in a third of the time of -O2 with all checks, and misses nothing: null pointers and what lies outside an
  # object stop the address sanitizer, misaligned vectors the processor.
  target_compile_options(stormfield_options INTERFACE -fsanitize=${STORMFIELD_SANITIZE}
    -fno-sanitize=null,object-size,alignment -fno-omit-frame-pointer -O1 -g1)
  target_link_options(stormfield_options INTERFACE -fsanitize=${STORMFIELD_SANITIZE})
endif()
