// Scalar and array types shared by the whole core.
#pragma once

#include <complex>
#include <cstdint>

#include <Eigen/Geometry>

namespace stormfield {

using Index = std::int32_t;
/// "There is none": the twin of a boundary halfedge, the face of a missed query.
inline constexpr Index kNone = -1;

/// A tangent vector: real part along the frame's x axis, imaginary part along its y axis.
using Complex = std::complex<double>;
using Vec3 = Eigen::Vector3d;
/// n x 3, one position (or vector) per row, mesh units.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// m x 3, one triangle of vertex indices per row, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<Index, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace stormfield
