#include "design/even_speed.h"

#include <cmath>

#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/message.h"
#include "solver/connection_laplacian.h"

namespace stormfield {
namespace {

/// |grad V|^2 / 2 at the rows, from half of the energy of each of their edges.
std::vector<double> gradientSquares(const SurfaceMatrix& matrix, const std::vector<Complex>& v, double totalArea) {
  std::vector<double> squares(matrix.rows());
  for (Index i = 0; i < matrix.rows(); ++i) {
    double energy = 0.0;
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
      // The entry is -weight * rotation: |entry| |V_i + entry / |entry| V_j|^2 is the energy of the edge.
      const double weight = std::abs(matrix.value[k]);
      energy += weight * std::norm(v[i] + matrix.value[k] / weight * v[matrix.column[k]]);
    }
    squares[i] = 0.25 * energy / (matrix.mass[i] * totalArea);
  }
  return squares;
}

/// Mean over a row and its neighbours, weighted by area.
double ringMean(const SurfaceMatrix& matrix, const std::vector<double>& values, Index i) {
  double sum = matrix.mass[i] * values[i];
  double mass = matrix.mass[i];
  for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
    sum += matrix.mass[matrix.column[k]] * values[matrix.column[k]];
    mass += matrix.mass[matrix.column[k]];
  }
  return sum / mass;
}

double fastMean(const ParameterizedField& field) {
  const TriangleMesh& mesh = field.charts->mesh();
  double first = 0.0, second = 0.0;
  for (Index j = 0; j < field.sampleCount(); ++j) {
    for (Index i = 0; i < mesh.vertexCount(); ++i) {
      if (mesh.outgoing(i) == kNone) continue;
      const double square = std::norm(field.sample(j)[i]);
      first += mesh.vertexArea(i) * std::sqrt(square);
      second += mesh.vertexArea(i) * square;
    }
  }
  return first > 0.0 ? second / first : 0.0;
}

}  // namespace

ParameterizedField evenSpeed(const ParameterizedField& field, double amount, double reach) {
  if (!(amount >= 0.0 && amount <= 1.0)) throw InputError(message("even speed must be 0 to 1, not ", amount));
  if (!(reach > 0.0) || !std::isfinite(reach)) {
    throw InputError(message("the reach of even speed must be a length above zero, not ", reach));
  }
  ParameterizedField result = field;
  const double speed = fastMean(field);
  if (amount == 0.0 || speed == 0.0) return result;

  const ConnectionLaplacian laplacian = connectionLaplacian(*field.charts);
  const SurfaceMatrix& matrix = laplacian.matrix;
  const double totalArea = field.charts->mesh().totalArea();
  tbb::parallel_for(Index{0}, field.sampleCount(), [&](Index j) {
    const Complex* from = field.sample(j);
    Complex* to = result.values.data() + static_cast<std::size_t>(j) * field.vertexCount();
    std::vector<Complex> v(matrix.rows());
    for (Index i = 0; i < matrix.rows(); ++i) v[i] = from[laplacian.vertex[i]];
    const std::vector<double> squares = gradientSquares(matrix, v, totalArea);
    for (Index i = 0; i < matrix.rows(); ++i) {
      const double faded = std::sqrt(std::norm(v[i]) + reach * reach * ringMean(matrix, squares, i));
      if (faded > 0.0) to[laplacian.vertex[i]] = v[i] * std::pow(speed / faded, amount);
    }
  });
  return result;
}

}  // namespace stormfield
