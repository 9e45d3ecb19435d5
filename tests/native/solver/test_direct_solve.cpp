#include <string>
#include <tuple>

#include "long_tests.h"
#include "solver/solver_checks.h"

namespace stormfield {
namespace {

using namespace solving;

struct OracleCase {
  const char* name;
  ChartsPointer charts;
  Index samples;
  Index constrainedVertices;
};

std::vector<OracleCase> oracleCases() {
  const bool many = test::longTests();
  const auto sphere = test::makeCharts(test::dividedIcosahedron(many ? 5 : 4));
  const auto torus = many ? test::makeCharts(test::torus(18, 9, 1.0, 0.4, 0.25))
                          : test::makeCharts(test::torus(12, 7, 1.0, 0.4, 0.25));
  const auto ring = many ? annulus(24, 5) : annulus(15, 4);
  const auto several =
      together({test::makeCharts(test::dividedIcosahedron(3)), annulus(12, 3), test::makeCharts(test::torus(10, 6))});
  const Index two =
      test::makeCharts(test::dividedIcosahedron(3))->mesh().vertexCount() + annulus(12, 3)->mesh().vertexCount();
  return {{"sphere", sphere, many ? 20 : 9, sphere->mesh().vertexCount()},
          {"torus", torus, many ? 13 : 10, torus->mesh().vertexCount()},
          {"annulus", ring, many ? 21 : 12, ring->mesh().vertexCount()},
          {"one sample", torus, 1, torus->mesh().vertexCount()},
          {"two samples", ring, 2, ring->mesh().vertexCount()},
          {"cube", test::makeCharts(test::cube()), 7, 8},
          {"several components", several, many ? 10 : 6, two}};
}

TEST(SpaceTimeSolver, AgreesWithADirectSolve) {
  for (const OracleCase& test : oracleCases()) {
    for (const auto& [soft, hard] : {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
      SCOPED_TRACE(std::string(test.name) + (soft ? " soft" : "") + (hard ? " hard" : ""));
      const ConstraintSet constraints =
          randomConstraints(*test.charts, test.samples, soft, hard, 7, test.constrainedVertices);
      SpaceTimeOptions options;
      options.samples = test.samples;
      options.tolerance = 1e-11;
      Progress progress;
      const SpaceTimeResult result = SpaceTimeSolver(test.charts, options).solve(constraints, progress);
      const std::vector<Complex> expected = directSolution(*test.charts, options, constraints);
      EXPECT_LT(difference(result.field.values, expected), 1e-8);
      EXPECT_LE(result.residual, 1e-11);
      EXPECT_EQ(progress.fraction(), 1.0);
      for (std::size_t k = 0; k < constraints.size(); ++k) {
        if (!std::isinf(constraints.weight[k])) continue;
        EXPECT_EQ(result.field.sample(constraints.sample[k])[constraints.vertex[k]], constraints.value[k]);
      }
    }
  }
}

TEST(SpaceTimeSolver, EditsOfAnyKindAgreeWithADirectSolve) {
  // One state through edits that add, move and drop soft and hard constraints and whole components, at a tolerance
  // where the field must be right, and at one where single precision alone must tell the truth about its residual.
  const auto first = test::makeCharts(test::dividedIcosahedron(3));
  const ChartsPointer charts = together({first, annulus(12, 3)});
  const Index all = charts->mesh().vertexCount() - 1, some = first->mesh().vertexCount();
  std::vector<ConstraintSet> edits;
  for (const auto& [soft, hard, seed, vertices] : {std::tuple{true, false, 1u, all},
                                                   {true, false, 2u, all},
                                                   {true, true, 2u, all},
                                                   {false, true, 3u, some},
                                                   {false, true, 3u, all},
                                                   {true, false, 4u, some},
                                                   {true, false, 4u, all}}) {
    edits.push_back(randomConstraints(*charts, 9, soft, hard, seed, vertices));
  }
  // The same again a thousand times longer, and then a thousandth.
  for (const double factor : {1e9, 1e-9}) {
    ConstraintSet scaled = edits.back();
    for (Complex& value : scaled.value) value *= factor;
    edits.push_back(scaled);
  }
  for (const double tolerance : {1e-11, 1e-4}) {
    const SpaceTimeOptions options{.samples = 9, .tolerance = tolerance};
    const SpaceTimeSolver solver(charts, options);
    SpaceTimeState state;
    Progress progress;
    for (std::size_t k = 0; k < edits.size(); ++k) {
      SCOPED_TRACE(k);
      const SpaceTimeResult result = solver.solve(edits[k], progress, state);
      EXPECT_LE(result.residual, tolerance);
      const std::vector<Complex> expected = directSolution(*charts, options, edits[k]);
      EXPECT_LT(difference(result.field.values, expected), 1000 * tolerance);
    }
  }
}

}  // namespace
}  // namespace stormfield
