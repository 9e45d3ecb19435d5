// What the field must show of a design with storms: zeros on the paths, and no others nearby (issue of the storm
// merge).
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "design/detail/surface_path.h"
#include "design/element_constraints.h"
#include "fixtures.h"
#include "solver/space_time_solver.h"
#include "topology/fixed_points.h"

namespace stormfield::storms {

using test::ChartsPointer;

inline DesignElement singular(const std::string& name, SingularKind kind, std::vector<Vec3> points,
                              std::vector<double> lambdas, double radius) {
  DesignElement element;
  element.name = name;
  element.kind = kind;
  element.points = std::move(points);
  element.lambdas = std::move(lambdas);
  element.radius = radius;
  return element;
}

/// a and b meet in `meeting` at lambda 0.6, from where they go on to `last` as one.
inline std::vector<DesignElement> merge(SingularKind kind, const Vec3& a, const Vec3& b, const Vec3& meeting,
                                        const Vec3& last, double radius) {
  return {singular("a", kind, {a, meeting}, {0.0, 0.6}, radius), singular("b", kind, {b, meeting}, {0.0, 0.6}, radius),
          singular("one", kind, {meeting, last}, {0.6, 1.0}, radius)};
}

/// The same backwards in lambda.
inline std::vector<DesignElement> reversed(std::vector<DesignElement> elements) {
  for (DesignElement& e : elements) {
    std::reverse(e.points.begin(), e.points.end());
    e.lambdas = {1.0 - e.lambdas[1], 1.0 - e.lambdas[0]};
  }
  return elements;
}

inline SpaceTimeResult solved(const ChartsPointer& charts, const std::vector<DesignElement>& elements, Index samples,
                              double tolerance = 1e-4) {
  ElementOptions options;
  options.samples = samples;
  SpaceTimeOptions solve;
  solve.samples = samples;
  solve.tolerance = tolerance;
  Progress progress;
  return SpaceTimeSolver(charts, solve).solve(elementConstraints(charts, elements, options), progress);
}

/// The storm that stands for a path, of the right kind.
inline void checkStorm(const FixedPoint& storm, const DesignElement& element, double lambda) {
  const Complex rot = rotation(element.kind);
  if (std::abs(rot.imag()) > 0.1) {
    EXPECT_GT(storm.rotation * rot.imag(), 0.0) << element.name << " at lambda " << lambda;
  }
  if (std::abs(rot.real()) > 0.1) {
    EXPECT_GT(storm.jacobian.trace() * rot.real(), 0.0) << element.name << " at lambda " << lambda;
  }
}

/// The elements "one" after lambdaC, the others before; the other way round where one storm splits.
inline std::vector<DesignElement> actingAt(const std::vector<DesignElement>& elements, double lambda, double lambdaC,
                                           bool merge) {
  std::vector<DesignElement> acting;
  const bool single = std::abs(lambda - lambdaC) <= 1e-9 || (lambda > lambdaC) == merge;
  for (const DesignElement& element : elements)
    if ((element.name == "one") == single) acting.push_back(element);
  return acting;
}

/// Every path has a storm of its own within one edge length at sample j, of its kind, and the indices add up to the
/// Euler characteristic. Returns the number of fixed points within a radius of the storms.
inline std::size_t checkSample(const SpaceTimeResult& result, const std::vector<DesignElement>& elements, Index j,
                               double lambdaC, bool merge) {
  const TriangleMesh& mesh = result.field.charts->mesh();
  const ClosestPointQuery query(result.field.charts->meshPointer());
  const double lambda = result.field.lambdas[j];
  const std::vector<FixedPoint> found = findFixedPoints(sampleField(result.field, j));
  const std::vector<DesignElement> acting = actingAt(elements, lambda, lambdaC, merge);
  std::vector<Vec3> places;
  for (const DesignElement& element : acting) places.push_back(SurfacePath(mesh, query, element).positionAt(lambda));

  // One or two storms: the choice of fixed points whose farthest is closest.
  std::vector<std::size_t> best;
  double least = 1e9;
  for (std::size_t p = 0; p < found.size(); ++p)
    for (std::size_t q = 0; q < found.size(); ++q) {
      if (found[p].index != 1 || found[q].index != 1 || (places.size() == 2) == (p == q)) continue;
      const double farthest =
          std::max((found[p].position - places.front()).norm(), (found[q].position - places.back()).norm());
      if (farthest >= least) continue;
      least = farthest;
      best = {p, q};
    }
  EXPECT_LT(least, mesh.meanEdgeLength()) << "lambda " << lambda;
  for (std::size_t i = 0; i < acting.size() && !best.empty(); ++i) checkStorm(found[best[i]], acting[i], lambda);

  std::size_t nearby = 0;
  int sum = 0;
  for (const FixedPoint& p : found) {
    nearby += std::any_of(places.begin(), places.end(), [&](const Vec3& place) {
      return (p.position - place).norm() < elements.front().radius.largest();
    });
    sum += p.index;
  }
  if (mesh.boundaryLoopCount() == 0) {
    EXPECT_EQ(sum, mesh.eulerCharacteristic()) << "lambda " << lambda;
  }
  return nearby;
}

/// Before lambdaC (after it, for a split) two storms, after it one, and no other change of their neighbourhood than the
/// saddle that comes near.
inline void checkMerge(const SpaceTimeResult& result, const std::vector<DesignElement>& elements, double lambdaC,
                       bool merge = true) {
  for (Index j = 0; j < result.field.sampleCount(); ++j) {
    const std::size_t nearby = checkSample(result, elements, j, lambdaC, merge);
    const double lambda = result.field.lambdas[j];
    const bool single = merge ? lambda >= lambdaC - 1e-9 : lambda <= lambdaC + 1e-9;
    if (single) {
      EXPECT_EQ(nearby, 1u) << "lambda " << lambda;
    } else {
      EXPECT_TRUE(nearby == 2 || nearby == 3) << nearby << " at lambda " << lambda;
    }
  }
}

}  // namespace stormfield::storms
