// One streamline through a seed, as long as no other line is near: it ends where another line (or an earlier part of
// itself) is nearer than the test distance, at the boundary and at a fixed point; and closes where it returns to its
// beginning (thesis 3.4; Jobard and Lefer 1997).
//
//   LineTracer tracer(faces, field, rules, lines);
//   const Line line = tracer.trace(seed, 0, Reach::Both, nullptr);
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
  bool fullStart = false, fullEnd = false;  ///< the width does not fall there: at the boundary, at a saddle
  Index given = kNone;                      ///< the curve it was made from, kNone for a traced one

  double length() const;
};

enum class Reach { Both, Forward, Backward };

struct LineRules {
  double distance = 0.0;      ///< d, mesh units
  double testDistance = 0.0;  ///< nearer than this to another line, a line ends; mesh units
  double step = 0.0;          ///< between the points of a line, mesh units
  double minSpeed = 0.0;      ///< fraction of the fastest vertex's speed at which lines end
  std::size_t maxPoints = 0;  ///< of one half of a line
};

class LineTracer {
 public:
  LineTracer(const FlatFaces& faces, const VectorField& field, const LineRules& rules, NearLines& lines);

  /// The line through the seed; its points are added to the lines under this number. They stay there: forget() removes
  /// those of the last line when it is not wanted.
  Line trace(const SurfacePoint& seed, Index number, Reach reach, const Progress* progress);
  void forget();

  LineSample sample(const LinePoint& p, Index line, double arc) const;

 private:
  struct Side;
  struct OwnArc;
  void extend(Side& side, const Progress* progress);
  bool step(Side& side, double length);
  bool closesOrSpirals(Side& side, std::size_t from);
  bool nearsOtherLine(const Side& side);
  bool nearsOwnBeginning(const Side& side);
  OwnArc ownArc(const Side& side) const;
  void endAt(Side& side, std::size_t count);
  void append(Side& side, const SurfacePoint& point);
  void cutBack(Side& side, std::size_t count);
  std::optional<double> passesSeed(const Side& side, std::size_t from) const;
  std::size_t pointsBeforeSeed(const Side& side) const;
  void close(Side& side);
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
