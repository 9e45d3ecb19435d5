// Faces near a short curve on the surface, by unfolding them into the plane of one of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <vector>

#include "tracing/flat_faces.h"

namespace stormfield {

/// From one flat frame to another: z -> rotation z + offset, without stretching.
struct Isometry {
  Complex rotation{1.0, 0.0}, offset{0.0, 0.0};

  Complex operator()(Complex z) const { return rotation * z + offset; }
  /// First `inner`, then this.
  Isometry after(const Isometry& inner) const { return {rotation * inner.rotation, rotation * inner.offset + offset}; }
};

/// The flat frame of the face across halfedge h of a face (not on the boundary), laid into the frame of that face.
Isometry unfold(const FlatFaces& faces, Index h);

/// One face laid into the plane of another, without turning around more than one vertex: none, or one way for the same
/// face or one across an edge; two (one for each way around) across a vertex, unless the boundary is in the way.
class Unfoldings {
 public:
  Unfoldings(const FlatFaces& faces, Index base, Index other);

  int count() const { return count_; }
  const Isometry& operator[](int i) const { return ways_[i]; }
  /// How far the ways around a vertex may lay a point of the other face apart, when a curve comes to it from a point of
  /// the base: 0 where only one way comes into question or the surface is flat.
  double spread(Complex inBase, Complex inOther) const;

 private:
  void turnAround(Index base, Index other, int corner, bool counterClockwise);

  const FlatFaces* faces_;
  Index base_;
  Isometry ways_[2];
  int count_ = 0;
  int side_ = -1, pivot_ = -1;  ///< side or corner of the base where the two faces meet
};

/// Collects the faces within a distance of a segment, which starts in face `base` and is given in its flat frame, and
/// the boundary halfedges among their sides.
class NearFaces {
 public:
  explicit NearFaces(const FlatFaces& faces) : faces_(&faces) {}

  /// Appends the faces to `list`; onBoundary(halfedge) is told the boundary halfedges within the distance.
  template <typename OnBoundary>
  void collect(Index base, Complex from, Complex to, double distance, std::vector<Index>& list,
               const OnBoundary& onBoundary);

 private:
  struct Laid {
    Index face, entered;  ///< the halfedge of the face that was stepped over, kNone for the first
    Isometry toBase;
  };

  bool visit(Index f) {
    if (visited_.size() == kFew) return visitedToo_.insert(f).second;
    if (std::find(visited_.begin(), visited_.end(), f) != visited_.end()) return false;
    visited_.push_back(f);
    if (visited_.size() == kFew) visitedToo_.insert(visited_.begin(), visited_.end());
    return true;
  }

  const FlatFaces* faces_;
  std::vector<Laid> stack_;
  static constexpr std::size_t kFew = 32;  ///< may be searched one by one
  std::vector<Index> visited_;
  std::unordered_set<Index> visitedToo_;  ///< all, where they are more
};

/// Edge length of the square of twice the face's area.
inline double faceSize(const FlatFace& face) {
  return std::sqrt(face.corner(1).real() * face.corner(2).imag());
}

/// Distance between the segments p q and a b in the plane.
double segmentDistance(Complex p, Complex q, Complex a, Complex b);

inline double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}

/// Whether the segment p q is on one side of the line through a and b, farther away than a distance.
inline bool isBeside(Complex p, Complex q, Complex a, Complex b, double distance) {
  const double fromP = cross(b - a, p - a), fromQ = cross(b - a, q - a);
  return fromP * fromQ > 0.0 && std::min(fromP * fromP, fromQ * fromQ) > distance * distance * std::norm(b - a);
}

// Inline: called for every pair of samples ---------------------------------------------------------------------------

template <typename OnBoundary>
void NearFaces::collect(Index base, Complex from, Complex to, double distance, std::vector<Index>& list,
                        const OnBoundary& onBoundary) {
  visited_.assign(1, base);
  if (!visitedToo_.empty()) visitedToo_.clear();
  stack_.assign(1, {base, kNone, {}});
  while (!stack_.empty()) {
    const Laid at = stack_.back();
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
