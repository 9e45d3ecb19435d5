// One streamline through a seed, as far as there is room: it ends where another line (or it itself) is nearer than the
// test distance, at the boundary, at a fixed point; and closes where it comes back onto its beginning.
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "streamlines/detail/near_lines.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

struct LinePoint {
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
};

/// A line in the flow's direction. A closed one does not repeat its first point.
struct Line {
  std::vector<LinePoint> points;
  bool closed = false;
  bool fullStart = false, fullEnd = false;  ///< the width does not fall there: the boundary, or a saddle
  Index given = kNone;                      ///< the curve it was made from, kNone for a traced one

  double length() const;
};

enum class Reach { Both, Forward, Backward };

struct LineRules {
  double distance = 0.0;      ///< d, mesh units
  double testDistance = 0.0;  ///< nearer than this to another line, a line ends; mesh units
  double step = 0.0;          ///< between the points of a line, mesh units
  double minSpeed = 0.0;      ///< part of the fastest vertex's speed at which lines end
  std::size_t mostPoints = 0;
};

class LineTracer {
 public:
  LineTracer(const FlatFaces& faces, const VectorField& field, const LineRules& rules, NearLines& lines);

  /// The line through the seed; number is the name under which its points are added to the lines. They stay there: take
  /// them back with forget() when the line is not wanted.
  Line trace(const SurfacePoint& seed, Index number, Reach reach, const Progress* progress);
  void forget();

  LineSample sample(const LinePoint& p, Index line, double arc) const;

 private:
  struct Side;
  void extend(Side& side, const Progress* progress);
  bool step(Side& side, double length);
  void append(Side& side, const SurfacePoint& point);
  void cutBack(Side& side, std::size_t count);
  std::optional<double> comesBack(const Side& side, std::size_t from) const;
  std::size_t pointsBefore(const Side& side) const;
  void join(Side& side);
  SurfacePoint toTheLeft(const SurfacePoint& p, double distance) const;

  const FlatFaces& faces_;
  const VectorField& field_;
  LineRules rules_;
  double fastest_;
  NearLines& lines_;
  SurfacePatch patch_;
  std::size_t samplesBefore_ = 0;  ///< of other lines
  Index number_ = kNone;
  LinePoint seed_;
  Vec3 seedDirection_;  ///< unit, of the flow
};

}  // namespace stormfield
