#include "design/log_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "design/log_map_cache.h"

namespace stormfield {

namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
// Sources keep this barycentric distance from edges and vertices, where directions from the source degenerate.
constexpr double kInset = 1e-4;

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// The length of z. std::abs guards against numbers that no mesh has, at several times the cost.
double lengthOf(Complex z) {
  return std::sqrt(std::norm(z));
}

/// Corners of a face in its flat frame.
std::array<Complex, 3> flatCorners(const VertexCharts& charts, Index f) {
  const TriangleMesh& mesh = charts.mesh();
  const Index h = TriangleMesh::halfedge(f, 0);
  return {Complex(0.0), std::polar(mesh.edgeLength(mesh.edge(h)), charts.faceAngle(h)),
          -std::polar(mesh.edgeLength(mesh.edge(h + 2)), charts.faceAngle(h + 2))};
}

/// Direction of arrival, at the tail of h, of a line that comes from `toSource` (in a frame whose x axis lies along h,
/// y axis into the face of h). The line back to the source runs through that face, so that its chart angle is known.
Complex arrivalAt(const VertexCharts& charts, Index h, Complex toSource) {
  const Index v = charts.mesh().tail(h);
  return -std::polar(1.0, charts.tailAngle(h) + charts.scale(v) * std::arg(toSource));
}

/// Reaches `target` through the face of h, whose tail and head are known; h is the edge the line crosses.
bool unfold(const VertexCharts& charts, Index h, const LogMapEntry& tail, const LogMapEntry& head,
            LogMapEntry& target) {
  const TriangleMesh& mesh = charts.mesh();
  const double length = mesh.edgeLength(mesh.edge(h));
  const Index toTarget = TriangleMesh::prev(h);  // target -> tail
  const double fromTail = mesh.edgeLength(mesh.edge(toTarget));
  const double fromHead = mesh.edgeLength(mesh.edge(TriangleMesh::next(h)));
  const double along = (fromTail * fromTail + length * length - fromHead * fromHead) / (2.0 * length);
  const Complex t(along, std::sqrt(std::max(0.0, fromTail * fromTail - along * along)));
  const double x = (tail.distance * tail.distance + length * length - head.distance * head.distance) / (2.0 * length);
  const double ySquared = tail.distance * tail.distance - x * x;
  if (ySquared < 0.0) return false;
  const Complex s(x, -std::sqrt(ySquared));
  const double crossing = x + (t.real() - x) * -s.imag() / (t.imag() - s.imag());
  if (!(crossing >= 0.0 && crossing <= length)) return false;
  const double distance = lengthOf(t - s);
  if (distance >= target.distance) return false;
  const double whole = std::arg((length - s) / -s);  // clockwise: both are negative
  const double angle = std::arg((t - s) / -s);
  target.distance = distance;
  target.angle =
      tail.angle + wrapped(head.angle - tail.angle) * (whole < 0.0 ? std::clamp(angle / whole, 0.0, 1.0) : 0.0);
  // Frame at the target: x axis along target -> tail, y axis into the face.
  target.arrival = arrivalAt(charts, toTarget, (s - t) / -t);
  return true;
}

/// Reaches the head of h (its tail when not forward) along the edge alone, past obtuse corners and into shadows: the
/// vector from the source, transported, plus the edge. In a shadow that vector cuts corners, but distances never shrink
/// along the path; where a line through the faces exists as well, the small price on edges lets it win.
bool followEdge(const VertexCharts& charts, Index h, bool forward, const LogMapEntry& from, LogMapEntry& target) {
  constexpr double kPrice = 0.01;
  const double length = charts.mesh().edgeLength(charts.mesh().edge(h));
  if (from.distance + kPrice * length >= target.distance) return false;
  const Complex carried = (forward ? charts.transport(h) : std::conj(charts.transport(h))) * from.arrival;
  const Complex along = forward ? std::polar(1.0, charts.headAngle(h)) : -std::polar(1.0, charts.tailAngle(h));
  const Complex away = from.distance * carried + length * along;
  const double reached = lengthOf(away), distance = std::max(reached, from.distance) + kPrice * length;
  if (distance >= target.distance || reached == 0.0) return false;
  target.distance = distance;
  target.angle = from.angle + std::arg(away / carried);
  target.arrival = away / reached;
  return true;
}

}  // namespace

const LogMapEntry* LogMap::find(Index vertex) const {
  const auto it = std::lower_bound(entries.begin(), entries.end(), vertex,
                                   [](const LogMapEntry& e, Index v) { return e.vertex < v; });
  return it != entries.end() && it->vertex == vertex ? &*it : nullptr;
}

double LogMap::distance(const TriangleMesh& mesh, const SurfacePoint& p) const {
  if (p.face == source.face) return (position(mesh, p) - position(mesh, source)).norm();
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] == 0.0) continue;
    const LogMapEntry* entry = find(mesh.vertex(p.face, k));
    if (!entry) return kUnreached;
    sum += p.barycentric[k] * entry->distance;
  }
  return sum;
}

bool LogMap::reaches(const SurfacePoint& from, double maxDistance) const {
  return source.face == from.face && source.barycentric == from.barycentric && maxDistance <= radius;
}

LogMap LogMap::within(const TriangleMesh& mesh, double maxDistance) const {
  LogMap map{source, maxDistance, {}};
  const auto face = mesh.triangles().row(source.face).array();
  for (const LogMapEntry& entry : entries) {
    if (entry.distance < maxDistance || (face == entry.vertex).any()) map.entries.push_back(entry);
  }
  return map;
}

LogMapScratch::LogMapScratch(const TriangleMesh& mesh)
    : state_(static_cast<std::size_t>(mesh.vertexCount())), finished_(static_cast<std::size_t>(mesh.vertexCount()), 0) {
  for (LogMapEntry& entry : state_) entry.distance = kUnreached;
}

LogMap logMap(const VertexCharts& charts, const SurfacePoint& source, double radius, LogMapScratch& scratch) {
  const TriangleMesh& mesh = charts.mesh();
  std::vector<LogMapEntry>& state = scratch.state_;
  std::vector<Index> touched;
  using Item = std::pair<double, Index>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  const auto push = [&](Index v) {
    if (state[v].vertex == kNone) touched.push_back(v);
    state[v].vertex = v;
    queue.push({state[v].distance, v});
  };

  const Index f = source.face;
  const std::array<Complex, 3> corners = flatCorners(charts, f);
  const Eigen::Vector3d inset = source.barycentric.cwiseMax(kInset) / source.barycentric.cwiseMax(kInset).sum();
  const Complex centre = inset[0] * corners[0] + inset[1] * corners[1] + inset[2] * corners[2];
  double reach = radius;
  for (int k = 0; k < 3; ++k) {
    const Index h = TriangleMesh::halfedge(f, k), v = mesh.tail(h);
    const Complex away = corners[k] - centre;
    state[v].distance = std::abs(away);
    state[v].angle = std::arg(away);
    state[v].arrival = arrivalAt(charts, h, -away * std::polar(1.0, -charts.faceAngle(h)));
    push(v);
    reach = std::max(reach, state[v].distance);
  }

  // h is the edge between the settled vertex and another one, in the face that also holds the target.
  const auto cross = [&](Index h, Index target) {
    const LogMapEntry &tail = state[mesh.tail(h)], &head = state[mesh.head(h)];
    if (scratch.finished_[target] || tail.vertex == kNone || head.vertex == kNone) return;
    if (unfold(charts, h, tail, head, state[target])) push(target);
  };
  const auto follow = [&](Index h, bool forward) {
    const Index from = forward ? mesh.tail(h) : mesh.head(h), target = forward ? mesh.head(h) : mesh.tail(h);
    if (scratch.finished_[target]) return;
    if (followEdge(charts, h, forward, state[from], state[target])) push(target);
  };

  while (!queue.empty()) {
    const auto [distance, v] = queue.top();
    queue.pop();
    if (scratch.finished_[v]) continue;
    if (distance > reach) break;
    scratch.finished_[v] = 1;
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      const Index last = TriangleMesh::prev(h);
      cross(h, mesh.tail(last));
      cross(last, mesh.head(h));
      follow(h, true);
      if (mesh.twin(last) == kNone) follow(last, false);  // else it is an outgoing edge as well
    }
  }

  LogMap map{source, radius, {}};
  for (const Index v : touched) {
    const bool corner = mesh.vertex(f, 0) == v || mesh.vertex(f, 1) == v || mesh.vertex(f, 2) == v;
    if (corner || (scratch.finished_[v] && state[v].distance < radius)) map.entries.push_back(state[v]);
    state[v] = {};
    state[v].distance = kUnreached;
    scratch.finished_[v] = 0;
  }
  std::sort(map.entries.begin(), map.entries.end(),
            [](const LogMapEntry& a, const LogMapEntry& b) { return a.vertex < b.vertex; });
  return map;
}

std::shared_ptr<const LogMap> recentLogMap(const VertexCharts& charts, const SurfacePoint& source, double radius,
                                           LogMapScratch& scratch) {
  constexpr std::size_t kRecent = 8;
  if (scratch.kept_) {
    if (std::shared_ptr<const LogMap> map = scratch.kept_->find(charts.mesh(), source, radius)) return map;
  }
  std::vector<std::shared_ptr<const LogMap>>& recent = scratch.recent_;
  const auto found = std::find_if(recent.begin(), recent.end(), [&](const std::shared_ptr<const LogMap>& map) {
    return map->radius == radius && map->reaches(source, radius);
  });
  if (found != recent.end()) {
    std::rotate(recent.begin(), found, found + 1);
  } else {
    if (recent.size() == kRecent) recent.pop_back();
    recent.insert(recent.begin(), std::make_shared<const LogMap>(logMap(charts, source, radius, scratch)));
  }
  if (scratch.kept_) scratch.kept_->add(recent.front());
  return recent.front();
}

}  // namespace stormfield
