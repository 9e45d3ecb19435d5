// Positions and arcs on the boundary of a face, which is a circle of length 3: position = side + fraction along the
// side, counter-clockwise.
#pragma once

namespace stormfield {

/// An arc from `begin` counter-clockwise.
struct BoundaryArc {
  double begin = 0.0, length = 0.0;
};

inline constexpr BoundaryArc kWholeBoundary{0.0, 3.0};

/// The length of the arc from one position to another, counter-clockwise.
inline double arcLength(double from, double to) {
  const double length = to - from;
  return length < 0.0 ? length + 3.0 : length;
}

/// The position where a trajectory leaves a face, or none where it stays. As large as a double.
class ExitPosition {
 public:
  constexpr ExitPosition() = default;  ///< none
  constexpr ExitPosition(double position) : position_(position) {}

  constexpr bool exists() const { return position_ != kAbsent; }
  constexpr double operator*() const { return position_; }
  constexpr bool operator==(const ExitPosition&) const = default;

 private:
  static constexpr double kAbsent = -1.0;
  double position_ = kAbsent;
};
/// The trajectory stays in the face.
inline constexpr ExitPosition kNoExit{};

}  // namespace stormfield
