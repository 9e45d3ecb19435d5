#include "streamlines/detail/near_lines.h"

#include <algorithm>

namespace stormfield {
namespace {

double squaredDistanceToEdge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).squaredNorm();
}

}  // namespace

void SurfacePatch::gather(Index face, const Vec3& center, double radius) {
  if (++round_ == 0) {  // after four billion rounds
    std::fill(visited_.begin(), visited_.end(), 0U);
    round_ = 1;
  }
  faces_.assign(1, face);
  visited_[face] = round_;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const Index h = TriangleMesh::halfedge(faces_[i], k), twin = mesh_->twin(h);
      if (twin == kNone) continue;
      const Index neighbour = TriangleMesh::face(twin);
      if (visited_[neighbour] == round_) continue;
      if (squaredDistanceToEdge(center, mesh_->point(mesh_->tail(h)), mesh_->point(mesh_->head(h))) > radius * radius) {
        continue;
      }
      visited_[neighbour] = round_;
      faces_.push_back(neighbour);
    }
  }
}

NearLines::NearLines(const TriangleMesh& mesh, double cell)
    : mesh_(&mesh), origin_(mesh.points().colwise().minCoeff()), cell_(cell), heads_(1024, kEnd) {}

void NearLines::add(const LineSample& sample) {
  samples_.push_back(sample);
  next_.push_back(kEnd);
  if (samples_.size() <= heads_.size()) return link(samples_.size() - 1);
  heads_.assign(2 * heads_.size(), kEnd);
  for (std::size_t i = 0; i < samples_.size(); ++i) link(i);
}

void NearLines::link(std::size_t i) {
  std::uint32_t& head = heads_[bucket(cellOf(samples_[i].position))];
  next_[i] = head;
  head = static_cast<std::uint32_t>(i);
}

void NearLines::dropLast() {
  heads_[bucket(cellOf(samples_.back().position))] = next_.back();
  samples_.pop_back();
  next_.pop_back();
}

}  // namespace stormfield
