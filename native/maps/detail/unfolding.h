// Unfolding of neighbouring faces into the plane of one of them, and the faces near a short segment. An unfolded face
// keeps its lengths and angles; straight lines over its common edge are straightest geodesics (Polthier and Schmies
// 1998, "Straightest geodesics on polyhedral surfaces").
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>
#include <vector>

#include "tracing/flat_faces.h"

namespace stormfield {

/// A rigid motion from one flat frame to another: z -> rotation z + offset, |rotation| = 1.
struct Isometry {
  Complex rotation{1.0, 0.0}, offset{0.0, 0.0};

  Complex operator()(Complex z) const { return rotation * z + offset; }
  /// First `inner`, then this.
  Isometry after(const Isometry& inner) const { return {rotation * inner.rotation, rotation * inner.offset + offset}; }
};

/// From the flat frame of the face across halfedge h (which is not on the boundary) to that of the face of h.
Isometry unfold(const FlatFaces& faces, Index h);

/// The unfoldings of one face into the plane of another: one for the same face and for one across an edge, two for one
/// that shares a vertex (around the vertex on either side, unless the boundary interrupts it), none for others.
class Unfoldings {
 public:
  Unfoldings(const FlatFaces& faces, Index base, Index other);

  int count() const { return count_; }
  const Isometry& operator[](int i) const { return unfoldings_[i]; }
  /// The distance between the unfoldings of a point of the other face, for a curve that comes to it from a point of the
  /// base: 0 where the curve has one way only, and where the surface is flat.
  double spread(Complex inBase, Complex inOther) const;

 private:
  enum class Around { CounterClockwise, Clockwise };
  void unfoldAround(Index base, Index other, int corner, Around around);

  const FlatFaces* faces_;
  Index base_;
  Isometry unfoldings_[2];
  int count_ = 0;
  std::optional<int> side_, pivot_;  ///< side or corner of the base where the two faces meet
};

/// Collects the faces within a distance of a segment, which starts in face `base` and is given in its flat frame, and
/// the boundary halfedges within the distance. Faces are unfolded one across the other, without a limit on the
/// distance.
class NearFaces {
 public:
  explicit NearFaces(const FlatFaces& faces) : faces_(&faces) {}

  /// Appends the faces to `list` and calls onBoundary(halfedge) for the boundary halfedges.
  template <typename OnBoundary>
  void collect(Index base, Complex from, Complex to, double distance, std::vector<Index>& list,
               const OnBoundary& onBoundary);

 private:
  struct Unfolded {
    Index face, entered;  ///< the halfedge of the face over which it was reached, kNone for the first
    Isometry toBase;
  };

  bool visit(Index f) {
    if (visited_.size() == kFew) return manyVisited_.insert(f).second;
    if (std::find(visited_.begin(), visited_.end(), f) != visited_.end()) return false;
    visited_.push_back(f);
    if (visited_.size() == kFew) manyVisited_.insert(visited_.begin(), visited_.end());
    return true;
  }

  const FlatFaces* faces_;
  std::vector<Unfolded> stack_;
  static constexpr std::size_t kFew = 32;  ///< searched one by one faster than by hash
  std::vector<Index> visited_;             ///< the first kFew
  std::unordered_set<Index> manyVisited_;  ///< all, where they are more
};

/// The size of a face: the side of a square of twice its area.
inline double faceSize(const FlatFace& face) {
  return std::sqrt(face.corner(1).real() * face.corner(2).imag());
}

/// Distance between the segments p q and a b in the plane.
double segmentDistance(Complex p, Complex q, Complex a, Complex b);

inline double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}

/// Whether the segment p q lies on one side of the line through a and b, farther from it than a distance.
inline bool isBeside(Complex p, Complex q, Complex a, Complex b, double distance) {
  const double fromP = cross(b - a, p - a), fromQ = cross(b - a, q - a);
  return fromP * fromQ > 0.0 && std::min(fromP * fromP, fromQ * fromQ) > distance * distance * std::norm(b - a);
}

// Inline, because it is called for every pair of samples --------------------------------------------------------------

template <typename OnBoundary>
void NearFaces::collect(Index base, Complex from, Complex to, double distance, std::vector<Index>& list,
                        const OnBoundary& onBoundary) {
  visited_.assign(1, base);
  if (!manyVisited_.empty()) manyVisited_.clear();
  stack_.assign(1, {base, kNone, {}});
  while (!stack_.empty()) {
    const Unfolded at = stack_.back();
    stack_.pop_back();
    list.push_back(at.face);
    const FlatFace& flat = (*faces_)[at.face];
    Complex corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = at.toBase(flat.corner(i));
    for (int i = 0; i < 3; ++i) {
      const Index h = TriangleMesh::halfedge(at.face, i), twin = flat.twin(i);
      if (h == at.entered) continue;
      const Complex a = corners[i], b = corners[(i + 1) % 3];
      if (isBeside(from, to, a, b, distance)) continue;
      if (segmentDistance(from, to, a, b) > distance) continue;
      if (twin == kNone) {
        onBoundary(h);
      } else if (visit(TriangleMesh::face(twin))) {
        stack_.push_back({TriangleMesh::face(twin), twin, at.toBase.after(unfold(*faces_, h))});
      }
    }
  }
}

}  // namespace stormfield
