#include "edit/detail/harmonic_fill.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/detail/local_laplacian.h"

namespace stormfield {
namespace {

using Matrix = Eigen::SparseMatrix<Complex>;
using Vector = Eigen::VectorXcd;

/// What a neighbour's vector becomes at v, carried along the edge between them.
Complex carried(const VectorField& field, Index neighbour, Index edge, bool along) {
  const Complex transport = field.charts->transport(field.mesh().edgeHalfedge(edge));
  return (along ? std::conj(transport) : transport) * field.values[neighbour];
}

/// b - A x over the free vertices: the sum of w (V_neighbour, carried, - V).
Vector residualOf(const VectorField& field, const std::vector<Index>& freeVertices) {
  Vector residual(static_cast<Eigen::Index>(freeVertices.size()));
  for (std::size_t i = 0; i < freeVertices.size(); ++i) {
    Complex sum = 0.0;
    forEachNeighbour(field.mesh(), freeVertices[i], [&](Index neighbour, Index edge, bool along) {
      sum += positiveEdgeWeight(field.mesh(), edge) *
             (carried(field, neighbour, edge, along) - field.values[freeVertices[i]]);
    });
    residual[static_cast<Eigen::Index>(i)] = sum;
  }
  return residual;
}

Matrix matrixOf(const VectorField& field, const std::vector<Index>& freeVertices) {
  const TriangleMesh& mesh = field.mesh();
  const std::vector<Index> numbers = numbersOf(mesh, freeVertices);
  std::vector<Eigen::Triplet<Complex>> entries;
  for (const Index v : freeVertices) {
    forEachNeighbour(mesh, v, [&](Index neighbour, Index edge, bool along) {
      const double weight = positiveEdgeWeight(mesh, edge);
      entries.emplace_back(numbers[v], numbers[v], weight);
      if (numbers[neighbour] == kNone) return;
      const Complex transport = field.charts->transport(mesh.edgeHalfedge(edge));
      entries.emplace_back(numbers[v], numbers[neighbour], -weight * (along ? std::conj(transport) : transport));
    });
  }
  const auto size = static_cast<Eigen::Index>(freeVertices.size());
  Matrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void requireGivenNeighbours(const TriangleMesh& mesh, const std::vector<Index>& freeVertices) {
  const std::vector<Index> numbers = numbersOf(mesh, freeVertices);
  std::vector<char> seen(freeVertices.size(), 0);
  for (std::size_t first = 0; first < freeVertices.size(); ++first) {
    if (seen[first] != 0) continue;
    bool given = false;
    std::vector<Index> part{freeVertices[first]};
    seen[first] = 1;
    for (std::size_t i = 0; i < part.size(); ++i) {
      forEachNeighbour(mesh, part[i], [&](Index neighbour, Index, bool) {
        const Index number = numbers[neighbour];
        given = given || number == kNone;
        if (number == kNone || seen[number] != 0) return;
        seen[number] = 1;
        part.push_back(neighbour);
      });
    }
    if (!given) throw InputError("the region covers a whole surface; leave some of it outside");
  }
}

}  // namespace

VectorField harmonicFill(const VectorField& field, const std::vector<Index>& freeVertices) {
  requireGivenNeighbours(field.mesh(), freeVertices);
  VectorField filled = field;
  const Eigen::SimplicialLDLT<Matrix> factors(matrixOf(field, freeVertices));
  // The second and third time are steps of iterative refinement.
  for (int step = 0; step < 3; ++step) {
    const Vector correction = factors.solve(residualOf(filled, freeVertices));
    for (std::size_t i = 0; i < freeVertices.size(); ++i) {
      filled.values[freeVertices[i]] += correction[static_cast<Eigen::Index>(i)];
    }
  }
  return filled;
}

double harmonicResidual(const VectorField& field, const std::vector<Index>& freeVertices) {
  const Vector residual = residualOf(field, freeVertices);
  double largest = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < freeVertices.size(); ++i) {
    double weights = 0.0;
    forEachNeighbour(field.mesh(), freeVertices[i], [&](Index neighbour, Index edge, bool) {
      weights += positiveEdgeWeight(field.mesh(), edge);
      scale = std::max(scale, std::abs(field.values[neighbour]));
    });
    largest = std::max(largest, std::abs(residual[static_cast<Eigen::Index>(i)]) / weights);
  }
  return scale > 0.0 ? largest / scale : 0.0;
}

}  // namespace stormfield
