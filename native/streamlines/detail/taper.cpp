#include "streamlines/detail/taper.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace stormfield {
namespace {

/// Length over which the width falls to 0 at an end: distances d, but no more than this fraction of the line.
constexpr double kEnd = 1.5, kMaxEndFraction = 1.0 / 3.0;
/// Width of a line at the test distance from an earlier one; 1 at the distance d.
constexpr double kCrowded = 0.35;

std::vector<double> endTaper(const Line& line, double distance) {
  std::vector<double> taper(line.points.size(), 1.0), arc(line.points.size(), 0.0);
  if (line.closed) return taper;
  for (std::size_t i = 1; i < arc.size(); ++i) {
    arc[i] = arc[i - 1] + (line.points[i].position - line.points[i - 1].position).norm();
  }
  const double fall = std::min(kEnd * distance, kMaxEndFraction * arc.back());
  for (std::size_t i = 0; i < arc.size(); ++i) {
    if (!line.fullStart) taper[i] *= std::min(1.0, arc[i] / fall);
    if (!line.fullEnd) taper[i] *= std::min(1.0, (arc.back() - arc[i]) / fall);
  }
  return taper;
}

}  // namespace

std::vector<std::vector<double>> taperLines(const TriangleMesh& mesh, const std::vector<Line>& lines,
                                            const NearLines& samples, const LineRules& rules, Progress* progress) {
  std::vector<std::vector<double>> result(lines.size());
  tbb::enumerable_thread_specific<SurfacePatch> patches([&] { return SurfacePatch(mesh); });
  tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
    const Line& line = lines[i];
    result[i] = endTaper(line, rules.distance);
    if (line.given != kNone) return;
    const auto isEarlier = [&](const LineSample& s) { return s.line < static_cast<Index>(i); };
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      if (progress != nullptr) progress->check();
      const LinePoint& p = line.points[k];
      const auto neighbour = samples.nearest(p.position, p.point.face, rules.distance, patches.local(), isEarlier);
      if (!neighbour) continue;
      const double room = (neighbour->distance - rules.testDistance) / (rules.distance - rules.testDistance);
      result[i][k] *= kCrowded + (1.0 - kCrowded) * std::clamp(room, 0.0, 1.0);
    }
  });
  return result;
}

}  // namespace stormfield
