// The logarithmic map: geodesic polar coordinates around a point of the surface.
//
// A vertex v within the radius gets its distance from the source, the angle at which the geodesic to it leaves
// (in the flat frame of the source's face), and the direction in which it arrives, a unit number in the chart of v.
// A field W(z) given in the tangent plane of the source, z = distance exp(i angle), becomes at v
//     V = W(z) * frame,   frame = arrival exp(-i angle),
// which carries W along the geodesic. The arrival direction agrees with the interpolation inside faces (thesis 2.5), so
// that V = f(distance) * arrival has its zero in the source's own face.
//
// Distances are propagated from face to face by unfolding (the source's mirror image in the plane of the next face), in
// the order of distance as in Dijkstra's algorithm (Melvaer, Reimers 2012, Geodesic Polar Coordinates on Polygonal
// Meshes): the map follows the connectivity and never jumps over gaps or through thin sheets. Behind the cut locus each
// vertex keeps its shortest path.
#pragma once

#include <memory>
#include <vector>

#include "mesh/surface_point.h"
#include "mesh/vertex_charts.h"

namespace stormfield {

struct LogMapEntry {
  Index vertex = kNone;
  double distance = 0.0;  ///< mesh units
  double angle = 0.0;     ///< radians, in the flat frame of the source's face
  Complex arrival;        ///< unit, in the chart of the vertex

  Complex frame() const { return arrival * std::polar(1.0, -angle); }
};

struct LogMap {
  SurfacePoint source;
  double radius = 0.0;
  std::vector<LogMapEntry> entries;  ///< by vertex

  /// Entry of a vertex, or null when it was not reached.
  const LogMapEntry* find(Index vertex) const;
  /// Distance to a point, or infinity when its face was not reached.
  double distance(const TriangleMesh& mesh, const SurfacePoint& p) const;

  /// Whether it holds the map of that source and radius.
  bool reaches(const SurfacePoint& from, double maxDistance) const;
  /// That map, bit for bit.
  LogMap within(const TriangleMesh& mesh, double maxDistance) const;
};

class SampleLogMaps;

/// Arrays of one number per vertex that many maps share, and the last few maps: what stands still over many samples of
/// lambda has one map. One per thread.
class LogMapScratch {
 public:
  explicit LogMapScratch(const TriangleMesh& mesh);

  /// The maps that recentLogMap searches and extends from now on; null: none.
  void useKept(SampleLogMaps* maps) { kept_ = maps; }

 private:
  friend LogMap logMap(const VertexCharts&, const SurfacePoint&, double, LogMapScratch&);
  friend std::shared_ptr<const LogMap> recentLogMap(const VertexCharts&, const SurfacePoint&, double, LogMapScratch&);
  std::vector<LogMapEntry> state_;
  std::vector<char> finished_;
  std::vector<std::shared_ptr<const LogMap>> recent_;  ///< the last one used first
  SampleLogMaps* kept_ = nullptr;
};

/// All vertices closer than the radius, and always the corners of the source's face.
LogMap logMap(const VertexCharts& charts, const SurfacePoint& source, double radius, LogMapScratch& scratch);

/// The same, from the kept maps or the last few of the scratch where it is among them.
std::shared_ptr<const LogMap> recentLogMap(const VertexCharts& charts, const SurfacePoint& source, double radius,
                                           LogMapScratch& scratch);

}  // namespace stormfield
