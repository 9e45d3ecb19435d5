# Headers of libraries that most files of the core include, compiled once and read by every folder. Files include what
# they use all the same: the other builds of `make test-native` are without this.
get_property(folders GLOBAL PROPERTY STORMFIELD_FOLDERS)
set(first "")
foreach(folder ${folders})
  get_target_property(type ${folder} TYPE)
  if(NOT type STREQUAL STATIC_LIBRARY)
    continue()
  endif()
  # What ccache needs to recognize such files, with the sloppiness that the Makefile allows it.
  target_compile_options(${folder} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  if(first)
    target_precompile_headers(${folder} REUSE_FROM ${first})
  else()
    set(first ${folder})
    target_precompile_headers(${folder} PRIVATE <algorithm> <array> <atomic> <cmath> <functional> <limits> <map> <memory>
      <numeric> <optional> <string> <utility> <vector> <Eigen/Core> <Eigen/Geometry> <tbb/blocked_range.h>
      <tbb/enumerable_thread_specific.h> <tbb/parallel_for.h>)
  endif()
endforeach()
# They are compiled for another processor than the headers were.
set_source_files_properties(solver/detail/row_sums_avx2.cpp tracing/detail/face_path_avx2.cpp
  PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
