// Regular elements, streamlines and pathlines at one lambda (thesis 11.1.2, 11.1.3.3).
//
// A regular element prescribes its arrow on a disc, carried along geodesics. A streamline prescribes its own direction
// on a strip. A pathline prescribes, on a disc around the particle's place P at lambda, the particle's velocity: with
// d lambda = s dt that is s dP/dlambda, whatever the element's strength.
#pragma once

#include <optional>
#include <vector>

#include "design/detail/curve_strip.h"
#include "design/detail/region.h"
#include "design/detail/surface_path.h"
#include "design/log_map.h"

namespace stormfield {

/// One element that is not singular.
class OtherTargets {
 public:
  /// lambdaPerSecond is s above; stiffness as for SingularTargets.
  OtherTargets(const VertexCharts& charts, const ClosestPointQuery& query, const DesignElement& element, Index index,
               double stiffness, double lambdaPerSecond, LogMapScratch& scratch);

  /// Appends the targets of the sample at lambda, with cells of width step.
  void addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const;

 private:
  void addDisc(const LogMap& map, Complex velocity, double share, std::vector<Target>& targets) const;
  double density() const;

  const VertexCharts& charts_;
  DesignElement element_;
  Index index_;
  double stiffness_, lambdaPerSecond_;
  SurfacePath path_;
  LambdaSpan span_;
  LogMap still_;                   ///< of a regular element
  std::vector<StripEntry> strip_;  ///< of a streamline
};

}  // namespace stormfield
