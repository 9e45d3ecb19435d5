// A bifurcation at a chosen place and lambda (thesis 11.1.4).
//
// In the logarithmic map of the place, over the radius and turned by the axis, z = x + i y; L = (lambda - lambda_0) over
// the reach, held at its ends -1 and 1; A is half the final distance of the pair over the radius:
//   a sink and a saddle appear:     V = (A^2 L - x^2, -y)   (eq. 11.6);  they vanish: with -L
//   a source and a saddle vanish:   V = (A^2 L + x^2,  y)   (eq. 11.7);  they appear: with -L
//   Hopf birth: a sink becomes a source and sheds an attracting orbit:  V = z (A^2 L + i w - |z|^2);  death: with -L
// times the element's speed. The square of the pair's distance grows in proportion to L, to (2 A radius)^2, and the
// orbit's radius with its root, to A radius. What has appeared stays, and what vanishes was there before.
//
// Between vertices the field is linear, so that x^2 and |z|^2 z are seen a little larger than they are; what the mesh
// sees of them at the place is taken off, so that the event is where and when it is asked for.
#pragma once

#include "design/detail/element_targets.h"

namespace stormfield {

class BifurcationTargets : public ElementTargets {
 public:
  /// Throws InputError where the disc leaves the surface or the mesh does not resolve it.
  BifurcationTargets(const TargetContext& context, const DesignElement& element, Index index, LogMapScratch& scratch);

  const SurfacePoint& place() const { return map_.source; }
  const LogMap& map() const { return map_; }
  const LambdaSpan& span() const { return span_; }

 protected:
  void add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const override;

 private:
  Complex valueAt(Complex z, double unfolding) const;
  double seenSquare(const TriangleMesh& mesh) const;
  double seenTrace(const TriangleMesh& mesh) const;
  Complex flat(const LogMapEntry& entry) const;

  bool hopf_ = false;
  double axis_ = 0.0;
  double seen_ = 0.0;  ///< what the mesh makes of x^2, or of half the trace of |z|^2 z, at the place
  LogMap map_;
};

/// Throws InputError naming both where a bifurcation and another one, or a singular element, share a disc and lambda.
void keepBifurcationsAlone(const TriangleMesh& mesh, const std::vector<std::unique_ptr<ElementTargets>>& targets,
                           const std::vector<DesignElement>& elements, const ClosestPointQuery& query);

}  // namespace stormfield
