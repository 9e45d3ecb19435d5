// What one element that is no singular one asks of the field, lambda by lambda. A new type of element is a class here.
#pragma once

#include <memory>
#include <vector>

#include "design/detail/region.h"
#include "design/detail/surface_path.h"
#include "design/log_map.h"

namespace stormfield {

/// What all elements of a design have in common; the references outlive its targets.
struct TargetContext {
  const VertexCharts& charts;
  const ClosestPointQuery& query;
  double stiffness = 0.0;        ///< weight of a region's middle in units of 1 / radius^2
  double lambdaPerSecond = 1.0;  ///< s in d lambda = s dt
};

class ElementTargets {
 public:
  virtual ~ElementTargets() = default;
  ElementTargets(const ElementTargets&) = delete;
  ElementTargets& operator=(const ElementTargets&) = delete;

  const DesignElement& element() const { return element_; }

  /// Appends the targets of the sample at lambda, with cells of width step. Throws InputError.
  void addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const;

 protected:
  ElementTargets(const TargetContext& context, const DesignElement& element, Index index);

  /// The targets at full share.
  virtual void add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const = 0;

  /// Appends a target unless it has no weight; distance from the centre or curve, of the region of that radius.
  void push(std::vector<Target>& targets, Index vertex, Complex value, double distance, double radius,
            bool always) const;
  double speedAt(double lambda) const { return strengthAt(element_, lambda) * context_.charts.mesh().size(); }

  TargetContext context_;
  DesignElement element_;
  Index index_;
  SurfacePath path_;
  LambdaSpan span_;
};

/// Of an element that is not singular. Throws InputError where the element does not suit the surface.
std::unique_ptr<ElementTargets> makeTargets(const TargetContext& context, const DesignElement& element, Index index,
                                            LogMapScratch& scratch);

/// Narrows the strips of orbits that share lambda and would overlap, until they touch. Throws InputError naming two
/// that come too close for the mesh.
void keepOrbitsApart(const std::vector<std::unique_ptr<ElementTargets>>& targets);

}  // namespace stormfield
