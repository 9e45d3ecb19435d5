#include "design/border.h"

#include <cmath>

#include "design/detail/region.h"

namespace stormfield {

namespace {

/// Weight of the border's values, as that of a region of one edge length.
constexpr double kStiffness = 1e5;

}  // namespace

BorderFlow::BorderFlow(const VertexCharts& charts, Border border) : charts_(charts), border_(border) {
  if (border == Border::Open) return;
  const TriangleMesh& mesh = charts.mesh();
  std::vector<Complex> sum(mesh.vertexCount());
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    sum[mesh.tail(h)] += std::polar(1.0, charts.tailAngle(h));
    sum[mesh.head(h)] += std::polar(1.0, charts.headAngle(h));
  }
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (!(std::abs(sum[v]) > 1e-6)) continue;
    vertices_.push_back(v);
    along_.push_back(sum[v] / std::abs(sum[v]));
  }
}

double BorderFlow::speedAt(const Complex* values) const {
  double sum = 0.0;
  for (const Index v : vertices_) sum += std::abs(values[v]);
  return sum / static_cast<double>(vertices_.size());
}

Complex BorderFlow::valueAt(std::size_t i, Complex value, double speed) const {
  if (border_ == Border::Inflow) return Complex(0.0, speed) * along_[i];
  return along_[i] * (std::conj(along_[i]) * value).real();
}

void BorderFlow::settle(ParameterizedField& field) const {
  for (Index j = 0; j < field.sampleCount(); ++j) {
    Complex* values = field.values.data() + static_cast<std::size_t>(j) * field.vertexCount();
    const double speed = speedAt(values);
    for (std::size_t i = 0; i < vertices_.size(); ++i) values[vertices_[i]] = valueAt(i, values[vertices_[i]], speed);
  }
}

void BorderFlow::addTo(ConstraintSet& constraints, const ParameterizedField& field) const {
  const Index element = static_cast<Index>(constraints.elementNames.size());
  constraints.elementNames.push_back("border");
  const TriangleMesh& mesh = charts_.mesh();
  const double weight = centreDensity(kStiffness, mesh.size(), mesh.meanEdgeLength());
  for (Index j = 0; j < field.sampleCount(); ++j) {
    const double speed = speedAt(field.sample(j));
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      constraints.add(vertices_[i], j, valueAt(i, field.sample(j)[vertices_[i]], speed), weight, element);
  }
}

}  // namespace stormfield
