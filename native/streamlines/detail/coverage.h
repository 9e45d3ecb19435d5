// How far the surface is from the lines, and where a line is missing.
//
// Every new line leaves at the vertices around it how near it is. With the triangle inequality that settles most faces
// at once; the others are cut in four until each piece is known to be covered or is so small that its middle stands for
// it. So no gap is missed, whatever the size of the faces.
#pragma once

#include "base/progress.h"
#include "field/vector_field.h"
#include "streamlines/detail/near_lines.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// A point that is farther from every line than it should be.
struct Gap {
  SurfacePoint point;
  double distance;  ///< to the nearest line, mesh units; infinite beyond the radius that was looked at
};

class Coverage {
 public:
  /// reach: mesh units; gaps are points farther than this from every line. Pieces of the surface are told apart down to
  /// resolution, mesh units, so that no point is farther than reach + resolution where no gap is found. Where the field
  /// is slower than minSpeed there are no gaps.
  Coverage(const FlatFaces& faces, const VectorField& field, double reach, double resolution, double minSpeed);

  /// A sample of a line that stays.
  void add(const LineSample& sample);
  /// Part of the vertices that some line is near to, 0..1.
  double fraction() const { return static_cast<double>(reached_) / static_cast<double>(distance_.size()); }

  /// The nearest line is not farther than this from point p of a face; infinite where little is known.
  double bound(Index face, const Vec3& p) const;
  /// At least one point of every gap, the widest first. Faces without a gap are not looked at again: lines only come.
  std::vector<Gap> findGaps(const NearLines& lines, Progress* progress);

 private:
  struct Corners;
  void search(const NearLines& lines, Index face, const Corners& corners, SurfacePatch& patch,
              std::vector<Gap>& gaps) const;

  const FlatFaces& faces_;
  const VectorField& field_;
  double reach_, resolution_, minSpeed_;
  SurfacePatch patch_;
  std::vector<double> distance_;  ///< per vertex, to the nearest line that is near
  std::size_t reached_ = 0;
  std::vector<Index> open_;  ///< faces that may hold a gap
};

}  // namespace stormfield
