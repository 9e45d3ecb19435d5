// Texture coordinates that flow: for every frame, where the material at each vertex was when its cycle began.
//
// Coordinates that are carried without end would be stretched without limit, so each vertex x has two phases, half a
// period apart, and each starts anew once a period P (Max, Becker 1996, Flow Visualization Using Moving Textures;
// Neyret 2003, Advected Textures). With the offset o(x) of the vertex (texture/stagger.h)
//     cycle position  c_a = frame / P + o(x),   c_b = c_a + 1/2,      age = fractional part of c, in periods,
//     phase(x)        = x traced back along the unsteady advection field for age * P frames + offset of the cycle.
// The phases are 3D positions in object space, for solid textures on any mesh. Each cycle of each phase adds its own
// random vector (the same everywhere on the surface), so that texture comes back as another piece, never as a
// repetition.
//
// blend is the weight of phase b, 1 - blend that of a. It is exactly 0 or 1 in a dead zone around the instant at which
// the other phase starts anew, and offsets may not differ by more than the dead zone over an edge: so no triangle shows
// one phase at two cycles. A shader keeps the contrast of its texture T with mean m through
//     m + (w_a (T(a) - m) + w_b (T(b) - m)) / sqrt(w_a^2 + w_b^2).
//
// Each frame is computed from nothing but the inputs: any part of an animation gives the same bytes. Points whose
// path back reaches a boundary have their coordinates on it.
#pragma once

#include <memory>

#include "base/progress.h"
#include "tracing/pathline.h"

namespace stormfield {

struct AdvectionOptions {
  double framesPerSecond = 24.0;
  double period = 48.0;     ///< frames after which a phase starts anew
  double speed = 1.0;       ///< factor on the advection field
  double deadZone = 0.1;    ///< fraction of a period before and after a start that is invisible, above 0, below 1/4
  double renewal = 1.0;     ///< range of the random vectors in sizes of the object; 0: plain carried positions
  double tolerance = 1e-4;  ///< of the tracer, mean edge lengths per step
  std::uint64_t seed = 0;
};

/// Per vertex; vertices that no face uses keep their position.
struct AdvectedFrame {
  std::vector<float> phaseA, phaseB;  ///< x, y, z of each vertex, mesh units
  std::vector<float> blend;           ///< weight of b, 0..1
};

/// Distances of carried coordinates from those of a much finer trace, in mean edge lengths.
struct CarriedError {
  double mean = 0.0, largest = 0.0;  ///< at vertices: the error of the tracing
  double meanBetween = 0.0;          ///< at face centers: what linear interpolation inside visible faces adds
};

class AdvectedCoordinates {
 public:
  /// frames: increasing frame numbers (sub-frames allowed) with lambda at each; linear between, constant outside.
  /// Throws InputError for options without meaning, a bad track, or offsets too steep for the dead zone (names the
  /// edge).
  AdvectedCoordinates(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const ParameterizedField> field,
                      const std::vector<double>& frames, const std::vector<double>& lambdas,
                      const AdvectionOptions& options, std::vector<double> offsets);

  AdvectedFrame frame(double frame, Progress* progress = nullptr) const;
  /// Against traces of tolerance 1e-10, at about `samples` vertices and faces.
  CarriedError error(double frame, Index samples = 1000) const;

  const TriangleMesh& mesh() const { return faces_->mesh(); }
  const AdvectionOptions& options() const { return options_; }
  const std::vector<double>& offsets() const { return offsets_; }

 private:
  std::vector<Vec3> carried(const std::vector<PathlineSeed>& seeds, double tolerance, Progress* progress) const;
  PathlineSeed seed(const SurfacePoint& p, double frame, double cyclePosition) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const ParameterizedField> field_;
  AdvectionOptions options_;
  std::vector<double> offsets_;
  std::vector<Index> order_;  ///< vertices that faces use, neighbours near each other
  UnsteadyField flow_;
};

/// Weight of phase b where phase a has this age (0..1, in periods).
double blendWeight(double ageA, double deadZone);

}  // namespace stormfield
