# Compiler settings and dependencies of every target, in one place.
find_package(Eigen3 REQUIRED NO_MODULE)  # without a version: 5 does not count as compatible with 3.4, but is
if(Eigen3_VERSION VERSION_LESS 3.4)
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old; install Eigen 3.4 or newer")
endif()
find_package(TBB REQUIRED)
find_package(OpenImageIO REQUIRED)
# Debian's OpenImageIO names the headers of OpenCV, which nothing here needs and its package does not bring.
foreach(property INTERFACE_INCLUDE_DIRECTORIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES)
  get_target_property(directories OpenImageIO::OpenImageIO ${property})
  if(directories)
    list(FILTER directories EXCLUDE REGEX opencv)
    set_target_properties(OpenImageIO::OpenImageIO PROPERTIES ${property} "${directories}")
  endif()
endforeach()

# OpenVDB ships a find module only, and it wants to be told where.
find_path(OPENVDB_CMAKE_DIR FindOpenVDB.cmake PATH_SUFFIXES cmake/OpenVDB PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
if(OPENVDB_CMAKE_DIR)
  list(APPEND CMAKE_MODULE_PATH ${OPENVDB_CMAKE_DIR})
endif()
set(OpenVDB_FIND_QUIETLY TRUE)
find_package(OpenVDB REQUIRED)

add_library(stormfield_options INTERFACE)
# std::complex products without the checks for infinities that the field never contains.
target_compile_options(stormfield_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -fcx-limited-range $<$<BOOL:${STORMFIELD_WERROR}>:-Werror>)
target_compile_options(stormfield_options INTERFACE $<$<CONFIG:Release>:-O3>)
if(STORMFIELD_SANITIZE)
  # Compiles in a third of the time of -O2 with all checks, and misses nothing: null pointers and what lies outside an
  # object stop the address sanitizer, misaligned vectors the processor.
  target_compile_options(stormfield_options INTERFACE -fsanitize=${STORMFIELD_SANITIZE}
    -fno-sanitize=null,object-size,alignment -fno-omit-frame-pointer -O1 -g1)
  target_link_options(stormfield_options INTERFACE -fsanitize=${STORMFIELD_SANITIZE})
  # OpenVDB's templates take a quarter of an hour and 4 GB with all checks: targets that include them keep these alone.
  set(STORMFIELD_OPENVDB_OPTIONS -O1 -fno-sanitize=undefined)
endif()
