#include "design/brush.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "design/detail/curve_strip.h"
#include "design/detail/region.h"
#include "solver/connection_laplacian.h"

namespace stormfield {

namespace {

/// w above without its share of lambda; t: distance over radius.
double influence(double t, double falloff) {
  if (t >= 1.0) return 0.0;
  const double inner = 1.0 - falloff;
  return t <= inner ? 1.0 : 1.0 - smoothStep((t - inner) / falloff);
}

/// The smoothest field in a strip for the values around it.
class StripSmoother {
 public:
  StripSmoother(const VertexCharts& charts, const std::vector<StripEntry>& strip, const DesignElement& element)
      : laplacian_(connectionLaplacian(charts)), number_(laplacian_.vertex.size(), kNone) {
    std::vector<Index> rowOf(charts.mesh().vertexCount(), kNone);
    for (std::size_t row = 0; row < laplacian_.vertex.size(); ++row)
      rowOf[laplacian_.vertex[row]] = static_cast<Index>(row);
    for (const StripEntry& entry : strip) {
      number_[rowOf[entry.vertex]] = static_cast<Index>(rows_.size());
      rows_.push_back(rowOf[entry.vertex]);
    }
    std::vector<Eigen::Triplet<Complex>> entries;
    const SurfaceMatrix& m = laplacian_.matrix;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Index row = rows_[i];
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), m.diagonal[row]);
      for (std::size_t k = m.start[row]; k < m.start[row + 1]; ++k) {
        const Index other = number_[m.column[k]];
        if (other != kNone) entries.emplace_back(static_cast<int>(i), other, m.value[k]);
      }
    }
    Eigen::SparseMatrix<Complex> inside(static_cast<int>(rows_.size()), static_cast<int>(rows_.size()));
    inside.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(inside);
    if (factor_.info() != Eigen::Success || !bordered())
      throw InputError(describe(element) + " would smooth a whole part of the surface: make its radius smaller");
  }

  /// In the order of the strip.
  Eigen::VectorXcd operator()(const Complex* field) const {
    const SurfaceMatrix& m = laplacian_.matrix;
    Eigen::VectorXcd around = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t k = m.start[rows_[i]]; k < m.start[rows_[i] + 1]; ++k)
        if (number_[m.column[k]] == kNone)
          around[static_cast<Eigen::Index>(i)] -= m.value[k] * field[laplacian_.vertex[m.column[k]]];
    return factor_.solve(around);
  }

 private:
  /// Whether every vertex of the strip is joined, through it, to one outside.
  bool bordered() const {
    const SurfaceMatrix& m = laplacian_.matrix;
    std::vector<char> reached(rows_.size(), 0);
    std::vector<Index> open;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t k = m.start[rows_[i]]; k < m.start[rows_[i] + 1] && !reached[i]; ++k)
        if (number_[m.column[k]] == kNone) reached[i] = 1, open.push_back(static_cast<Index>(i));
    while (!open.empty()) {
      const Index row = rows_[open.back()];
      open.pop_back();
      for (std::size_t k = m.start[row]; k < m.start[row + 1]; ++k) {
        const Index other = number_[m.column[k]];
        if (other != kNone && !reached[other]) reached[other] = 1, open.push_back(other);
      }
    }
    return std::all_of(reached.begin(), reached.end(), [](char is) { return is != 0; });
  }

  ConnectionLaplacian laplacian_;
  std::vector<Index> number_;  ///< of a row in the strip, or kNone
  std::vector<Index> rows_;    ///< of the strip
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> factor_;
};

Complex brushed(BrushMode mode, Complex before, Complex stroke, double w) {
  switch (mode) {
    case BrushMode::Replace:
    case BrushMode::Smooth:
      break;
    case BrushMode::Add:
      return before + w * stroke;
    case BrushMode::Strength: {
      const double speed = std::abs(before);
      return speed > 0.0 ? before * ((speed + w * (std::abs(stroke) - speed)) / speed) : before;
    }
  }
  return (1.0 - w) * before + w * stroke;
}

void applyStroke(ParameterizedField& field, const ClosestPointQuery& query, const DesignElement& element,
                 Progress* progress) {
  const VertexCharts& charts = *field.charts;
  const SurfacePath path(charts.mesh(), query, element);
  std::vector<StripEntry> strip = curveStrip(charts, path, element.radius.largest());
  std::erase_if(strip, [&](const StripEntry& entry) { return entry.distance >= element.radius.largest(); });
  if (strip.empty())
    throw InputError(describe(element) + " covers no vertex of the mesh: make its radius larger, or refine the mesh");
  std::unique_ptr<const StripSmoother> smoother;
  if (element.mode == BrushMode::Smooth) smoother = std::make_unique<StripSmoother>(charts, strip, element);
  LambdaSpan span;
  span.start = element.lambdas.front();
  span.end = element.lambdas.back();
  const double step = field.sampleCount() > 1 ? field.lambdas[1] - field.lambdas[0] : 1.0;
  tbb::parallel_for(Index{0}, field.sampleCount(), [&](Index j) {
    if (progress) progress->check();
    const double lambda = field.lambdas[j];
    const double share = span.share(lambda, step) * holdAt(element, lambda);
    if (!(share > 0.0)) return;
    Complex* values = field.values.data() + static_cast<std::size_t>(j) * field.vertexCount();
    const Eigen::VectorXcd smooth = smoother ? (*smoother)(values) : Eigen::VectorXcd();
    const double speed = strengthAt(element, lambda) * charts.mesh().size(), radius = radiusAt(element, lambda);
    for (std::size_t i = 0; i < strip.size(); ++i) {
      const double w = share * influence(strip[i].distance / radius, element.falloff);
      if (!(w > 0.0)) continue;
      const Complex stroke = smoother ? smooth[static_cast<Eigen::Index>(i)] : speed * strip[i].direction;
      Complex& value = values[strip[i].vertex];
      value = brushed(element.mode, value, stroke, w);
    }
  });
}

}  // namespace

void applyBrushes(ParameterizedField& field, const std::vector<DesignElement>& elements, Progress* progress) {
  const bool any = std::any_of(elements.begin(), elements.end(),
                               [](const DesignElement& e) { return e.type == ElementType::Brush; });
  if (!any) return;
  const ClosestPointQuery query(field.charts->meshPointer());
  for (const DesignElement& element : elements)
    if (element.type == ElementType::Brush) applyStroke(field, query, element, progress);
}

}  // namespace stormfield
