#include "texture/stream_function.h"

#include <tbb/parallel_for.h>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
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
  static constexpr int kLanes = kTogether;

  explicit Factor(std::shared_ptr<const VertexCharts> c)
      : charts(std::move(c)), held(heldVertices(charts->mesh())), cholesky(laplacian(charts->mesh(), held)) {
    if (cholesky.info() != Eigen::Success) {
      throw SolverError("the stream function's Laplacian is singular; remove faces without area");
    }
    prepareFaces();
  }

  /// Mean of the field over face f is sum_i mean[3 f + i] V_i: the mean of the edges' midpoints, where the field is the
  /// blend of the two carried end vectors. side[3 f + i] is the side opposite to that corner, in the face's frame.
  void prepareFaces() {
    const TriangleMesh& mesh = charts->mesh();
    mean.resize(mesh.halfedgeCount());
    side.resize(mesh.halfedgeCount());
    tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
      const FaceInterpolant unit(*charts, f, {1.0, 1.0, 1.0});
      for (int i = 0; i < 3; ++i) {
        const double half = 0.5 * unit.twist[i] * mesh.cornerAngle(3 * f + i);
        mean[3 * f + i] = unit.carried[i] * std::cos(half) / 3.0;
        const Index h = 3 * f + (i + 1) % 3;
        side[3 * f + i] = std::polar(mesh.edgeLength(mesh.edge(h)), charts->faceAngle(h));
      }
    });
  }

  /// Row of a vertex in the factor, which has the lanes of each row side by side.
  std::size_t row(Index v) const { return static_cast<std::size_t>(cholesky.permutationP().indices()[v]) * kLanes; }

  /// The right-hand sides of `count` fields, in the rows of the factor; other lanes are 0.
  std::vector<double> curls(const Complex* values, int count) const {
    const TriangleMesh& mesh = charts->mesh();
    const std::size_t n = mesh.vertexCount();
    std::vector<double> result(n * kLanes, 0.0);
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      for (int lane = 0; lane < count; ++lane) {
        const Complex* field = values + lane * n;
        Complex v = 0.0;
        for (int i = 0; i < 3; ++i) v += mean[3 * f + i] * field[mesh.vertex(f, i)];
        for (int i = 0; i < 3; ++i) {
          // Integral of V . (grad hat_i x n): grad hat_i is the opposite side rotated into the face over twice the
          // area; rotated back it is the side itself.
          const Complex s = side[3 * f + i];
          result[row(mesh.vertex(f, i)) + lane] += 0.5 * (v.real() * s.real() + v.imag() * s.imag());
        }
      }
    }
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (held[v]) std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(row(v)), kLanes, 0.0);
    }
    return result;
  }

  /// x becomes the solution of L D L^T x = x in all lanes.
  void substitute(std::vector<double>& x) const {
    const Matrix& lower = cholesky.matrixL().nestedExpression();
    const int *start = lower.outerIndexPtr(), *row = lower.innerIndexPtr();
    const double* entry = lower.valuePtr();
    const auto n = lower.cols();
    std::array<double, kLanes> own;
    for (Eigen::Index j = 0; j < n; ++j) {
      double* at = x.data() + j * kLanes;
      std::copy_n(at, kLanes, own.data());
      for (int k = start[j]; k < start[j + 1]; ++k) {
        double* below = x.data() + static_cast<std::ptrdiff_t>(row[k]) * kLanes;
        for (int lane = 0; lane < kLanes; ++lane) below[lane] -= own[lane] * entry[k];
      }
    }
    const auto diagonal = cholesky.vectorD();
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      double* at = x.data() + j * kLanes;
      const double inverse = 1.0 / diagonal[j];
      for (int lane = 0; lane < kLanes; ++lane) own[lane] = inverse * at[lane];
      for (int k = start[j]; k < start[j + 1]; ++k) {
        const double* below = x.data() + static_cast<std::ptrdiff_t>(row[k]) * kLanes;
        for (int lane = 0; lane < kLanes; ++lane) own[lane] -= entry[k] * below[lane];
      }
      std::copy_n(own.data(), kLanes, at);
    }
  }

  void subtractMeans(double* psi) const {
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
  std::vector<Complex> mean, side;
  Eigen::SimplicialLDLT<Matrix> cholesky;
};

StreamFunctionSolver::StreamFunctionSolver(std::shared_ptr<const VertexCharts> charts)
    : factor_(std::make_unique<const Factor>(std::move(charts))) {}
StreamFunctionSolver::~StreamFunctionSolver() = default;
StreamFunctionSolver::StreamFunctionSolver(StreamFunctionSolver&&) noexcept = default;

std::vector<double> StreamFunctionSolver::solve(const Complex* values) const {
  return solve(values, 1);
}

std::vector<double> StreamFunctionSolver::solve(const Complex* values, int count) const {
  std::vector<double> lanes = factor_->curls(values, count);
  factor_->substitute(lanes);
  const Index n = factor_->charts->mesh().vertexCount();
  std::vector<double> psi(static_cast<std::size_t>(n) * count);
  for (int lane = 0; lane < count; ++lane) {
    double* own = psi.data() + static_cast<std::ptrdiff_t>(lane) * n;
    for (Index v = 0; v < n; ++v) own[v] = lanes[factor_->row(v) + lane];
    factor_->subtractMeans(own);
  }
  return psi;
}

std::vector<double> streamFunctions(const ParameterizedField& field, const StreamFunctionSolver& solver,
                                    Progress* progress) {
  constexpr int kTogether = StreamFunctionSolver::kTogether;
  std::vector<double> result(field.values.size());
  std::atomic<Index> done{0};
  tbb::parallel_for(Index{0}, (field.sampleCount() + kTogether - 1) / kTogether, [&](Index block) {
    if (progress != nullptr) progress->check();
    const Index first = block * kTogether, count = std::min<Index>(kTogether, field.sampleCount() - first);
    const std::vector<double> psi = solver.solve(field.sample(first), count);
    std::copy(psi.begin(), psi.end(), result.begin() + static_cast<std::ptrdiff_t>(first) * field.vertexCount());
    if (progress != nullptr) progress->report(static_cast<double>(done += count) / field.sampleCount());
  });
  return result;
}

}  // namespace stormfield
