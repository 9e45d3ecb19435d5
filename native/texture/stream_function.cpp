#include "texture/stream_function.h"

#include <tbb/parallel_for.h>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "field/interpolation.h"

namespace stormfield {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// One vertex of each component is held at 0, the others follow from the mean.
std::vector<char> heldVertices(const TriangleMesh& mesh) {
  std::vector<char> held(mesh.vertexCount(), 0);
  std::vector<char> seen(mesh.componentCount(), 0);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const Index component = mesh.component(v);
    if (component == kNone || !seen[component]) held[v] = 1;
    if (component != kNone) seen[component] = 1;
  }
  return held;
}

Matrix laplacian(const TriangleMesh& mesh, const std::vector<char>& held) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(mesh.faceCount()) * 12);
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    const Index i = mesh.tail(h), j = mesh.head(h);
    const double weight = 0.5 / std::tan(mesh.cornerAngle(TriangleMesh::prev(h)));
    if (!held[i]) entries.emplace_back(i, i, weight);
    if (!held[j]) entries.emplace_back(j, j, weight);
    if (held[i] || held[j]) continue;
    entries.emplace_back(i, j, -weight);
    entries.emplace_back(j, i, -weight);
  }
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (held[v]) entries.emplace_back(v, v, 1.0);
  }
  Matrix result(mesh.vertexCount(), mesh.vertexCount());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

struct StreamFunctionSolver::Factor {
  explicit Factor(std::shared_ptr<const VertexCharts> c)
      : charts(std::move(c)), held(heldVertices(charts->mesh())), cholesky(laplacian(charts->mesh(), held)) {
    if (cholesky.info() != Eigen::Success) {
      throw SolverError("the stream function's Laplacian is singular; remove faces without area");
    }
    prepareMeans();
  }

  /// Mean of the field over face f is sum_i mean[3 f + i] V_i: the mean of the edges' midpoints, where the field is the
  /// blend of the two carried end vectors.
  void prepareMeans() {
    mean.resize(charts->mesh().halfedgeCount());
    tbb::parallel_for(Index{0}, charts->mesh().faceCount(), [&](Index f) {
      const FaceInterpolant unit(*charts, f, {1.0, 1.0, 1.0});
      for (int i = 0; i < 3; ++i) {
        const double half = 0.5 * unit.twist[i] * charts->mesh().cornerAngle(3 * f + i);
        mean[3 * f + i] = unit.carried[i] * std::cos(half) / 3.0;
      }
    });
  }

  Eigen::VectorXd curl(const Complex* values) const {
    const TriangleMesh& mesh = charts->mesh();
    Eigen::VectorXd result = Eigen::VectorXd::Zero(mesh.vertexCount());
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      Complex v = 0.0;
      for (int i = 0; i < 3; ++i) v += mean[3 * f + i] * values[mesh.vertex(f, i)];
      for (int i = 0; i < 3; ++i) {
        // Integral of V . (grad hat_i x n): grad hat_i is the opposite side rotated into the face over twice the
        // area; rotated back it is the side itself.
        const Index h = 3 * f + (i + 1) % 3;
        const Complex side = std::polar(mesh.edgeLength(mesh.edge(h)), charts->faceAngle(h));
        result[mesh.vertex(f, i)] += 0.5 * (v.real() * side.real() + v.imag() * side.imag());
      }
    }
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (held[v]) result[v] = 0.0;
    }
    return result;
  }

  void subtractMeans(Eigen::VectorXd& psi) const {
    const TriangleMesh& mesh = charts->mesh();
    std::vector<double> sum(mesh.componentCount(), 0.0), area(mesh.componentCount(), 0.0);
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (mesh.component(v) == kNone) continue;
      sum[mesh.component(v)] += mesh.vertexArea(v) * psi[v];
      area[mesh.component(v)] += mesh.vertexArea(v);
    }
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (mesh.component(v) != kNone) psi[v] -= sum[mesh.component(v)] / area[mesh.component(v)];
    }
  }

  std::shared_ptr<const VertexCharts> charts;
  std::vector<char> held;
  std::vector<Complex> mean;
  Eigen::SimplicialLDLT<Matrix> cholesky;
};

StreamFunctionSolver::StreamFunctionSolver(std::shared_ptr<const VertexCharts> charts)
    : factor_(std::make_unique<const Factor>(std::move(charts))) {}
StreamFunctionSolver::~StreamFunctionSolver() = default;
StreamFunctionSolver::StreamFunctionSolver(StreamFunctionSolver&&) noexcept = default;

std::vector<double> StreamFunctionSolver::solve(const Complex* values) const {
  Eigen::VectorXd psi = factor_->cholesky.solve(factor_->curl(values));
  factor_->subtractMeans(psi);
  return {psi.data(), psi.data() + psi.size()};
}

std::vector<double> streamFunctions(const ParameterizedField& field, Progress* progress) {
  const StreamFunctionSolver solver(field.charts);
  std::vector<double> result(field.values.size());
  std::atomic<Index> done{0};
  tbb::parallel_for(Index{0}, field.sampleCount(), [&](Index j) {
    if (progress != nullptr) progress->check();
    const std::vector<double> psi = solver.solve(field.sample(j));
    std::copy(psi.begin(), psi.end(), result.begin() + static_cast<std::ptrdiff_t>(j) * field.vertexCount());
    if (progress != nullptr) progress->report(static_cast<double>(++done) / field.sampleCount());
  });
  return result;
}

}  // namespace stormfield
