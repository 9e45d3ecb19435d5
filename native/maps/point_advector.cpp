#include "maps/point_advector.h"

#include <array>
#include <cmath>
#include <type_traits>

#include "base/message.h"
#include "maps/detail/unit_speed_flow.h"
#include "maps/fixed_point_faces.h"
#include "tracing/side_by_side.h"

namespace stormfield {
namespace {

/// Part of the speed around a vertex below which the flow is no longer of unit speed.
constexpr double kSlow = 0.02;
/// A trace that gets on by less than this part of tau within the limit of steps is stuck.
constexpr double kStuck = 1e-6;
/// Turn of the field along a step, by its mean gradient.
constexpr double kTurnOfStep = 0.8;
/// A trace that so many steps take nowhere (barycentric) is at rest: it has come to a sink, as near as numbers can.
constexpr unsigned kRestSteps = 64;
constexpr double kRest = 1e-8;

double rateOf(Direction direction) {
  return direction == Direction::Backward ? -1.0 : 1.0;
}

/// A trace on its way: in stretches of many steps, as long as they get on, for it may be stuck in a face that is almost
/// a line.
class Journey {
 public:
  Journey() = default;
  Journey(const AdvectedPoint& from, double tau)
      : from_(from.point), before_(from.point), tau_(tau), radius_(from.radius), face_(from.point.face) {}

  const SurfacePoint& from() const { return from_; }
  double done() const { return done_; }
  double left() const { return tau_ - done_; }
  /// To be told of every step; here() is the point.
  template <typename Here>
  bool rests(const Here& here) {
    if (++steps_ % kRestSteps != 0) return false;
    const SurfacePoint p = here();
    const bool rest = p.face == before_.face && (p.barycentric - before_.barycentric).cwiseAbs().maxCoeff() < kRest;
    before_ = p;
    return rest;
  }
  /// To be told of every step too, where there is an error: the face it came to, and when in this stretch.
  void part(const DivergenceBound& parting, Index face, double time) {
    radius_ = parting.after(radius_, face_, time - time_);
    face_ = face;
    time_ = time;
  }
  /// After a stretch: whether another one follows, from its end.
  bool goesOn(const TraceEnd& end) {
    if (end.reason != StopReason::StepLimit || !(end.time > kStuck * tau_)) return false;
    from_ = end.point;
    done_ += end.time;
    time_ = 0.0;
    return true;
  }
  AdvectedPoint arrival(const TraceEnd& end) const { return {end.point, end.reason == StopReason::Boundary, radius_}; }

 private:
  SurfacePoint from_, before_;
  double tau_ = 0.0, done_ = 0.0, time_ = 0.0, radius_ = 0.0;
  Index face_ = kNone;
  unsigned steps_ = 0;
};

template <typename Flow>
class FlowAdvector final : public PointAdvector {
 public:
  FlowAdvector(const FlatFaces& faces, const Flow& flow, const TraceOptions& options, const DivergenceBound* parting,
               const Progress* progress)
      : integrator_(faces, flow, options, 0.0), divergenceBound_(parting), progress_(progress) {}

  AdvectedPoint advect(const AdvectedPoint& from, double tau) override {
    return follow(from, tau, [](const SurfacePoint&, double) {});
  }

  void advectAll(AdvectionQueue& moves) override {
    if constexpr (std::is_same_v<Flow, SteadyFlow>) {
      SideBySide work{*this, moves, {}, {}};
      traceSideBySide(integrator_, work);
    } else {
      AdvectedPoint from;
      double tau = 0.0;
      while (moves.next(0, from, tau)) moves.arrive(0, advect(from, tau));
    }
  }

  std::vector<TrajectoryPoint> trajectory(const SurfacePoint& from, double tau) override {
    std::vector<TrajectoryPoint> passages;
    follow({.point = from}, tau, [&](const SurfacePoint& p, double time) { passages.push_back({p, time}); });
    return passages;
  }

 private:
  template <typename Visit>
  AdvectedPoint follow(const AdvectedPoint& from, double tau, const Visit& visit) {
    Journey journey(from, tau);
    while (true) {
      const TraceEnd end =
          integrator_.run(journey.from(), 0.0, journey.left(), [&](const SurfacePoint& p, double time) {
            look();
            visit(p, journey.done() + time);
            if (divergenceBound_ != nullptr) journey.part(*divergenceBound_, p.face, time);
            return !journey.rests([&] { return p; });
          });
      if (!journey.goesOn(end)) return journey.arrival(end);
    }
  }

  static_assert(FaceSteps::kCount <= AdvectionQueue::kLanes);
  struct SideBySide {
    FlowAdvector& advector;
    AdvectionQueue& moves;
    std::array<Journey, AdvectionQueue::kLanes> journeys;
    std::array<bool, AdvectionQueue::kLanes> goesOn;

    bool next(int lane, SurfacePoint& seed, double& maxTime) {
      Journey& journey = journeys[lane];
      if (!goesOn[lane]) {
        AdvectedPoint from;
        double tau = 0.0;
        if (!moves.next(lane, from, tau)) return false;
        journey = Journey(from, tau);
      }
      seed = journey.from();
      maxTime = journey.left();
      journey.rests([&] { return seed; });
      return true;
    }
    bool step(int lane, const Integrator<Flow>& integrator) {
      advector.look();
      if (advector.divergenceBound_ != nullptr) {
        journeys[lane].part(*advector.divergenceBound_, integrator.here().face, integrator.elapsed());
      }
      return !journeys[lane].rests([&] { return integrator.here(); });
    }
    void end(int lane, const TraceEnd& traceEnd) {
      goesOn[lane] = journeys[lane].goesOn(traceEnd);
      if (!goesOn[lane]) moves.arrive(lane, journeys[lane].arrival(traceEnd));
    }
  };

  void look() {
    if (progress_ != nullptr && (++steps_ & 1023) == 0) progress_->check();
  }

  Integrator<Flow> integrator_;
  const DivergenceBound* divergenceBound_;
  const Progress* progress_;
  unsigned steps_ = 0;
};

/// Whether a boundary halfedge is crossed outwards: the field along it is the blend of its two end vectors.
bool crossedOutwards(const FlatFaces& faces, const VectorField& field, Index h) {
  const FlatFace& face = faces[TriangleMesh::face(h)];
  const int i = TriangleMesh::corner(h);
  const auto value = [&](int corner) { return field.values[face.vertex(corner)]; };
  const CarriedVectors vectors = face.carry(value(0), value(1), value(2));
  const Complex side = face.corner((i + 1) % 3) - face.corner(i);
  for (const double s : {1e-6, 0.5, 1.0 - 1e-6}) {
    const Complex v = face.evaluate(vectors, face.corner(i) + s * side);
    if ((std::conj(side) * v).imag() < 0.0) return true;
  }
  return false;
}

}  // namespace

std::vector<double> slowSpeeds(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<double> sum(field.values.size(), 0.0), weight(field.values.size(), 0.0);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    double mean = 0.0;
    for (int i = 0; i < 3; ++i) mean += std::abs(field.values[mesh.vertex(f, i)]) / 3.0;
    for (int i = 0; i < 3; ++i) {
      sum[mesh.vertex(f, i)] += mesh.faceArea(f) * mean;
      weight[mesh.vertex(f, i)] += mesh.faceArea(f);
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0.0 ? kSlow * sum[v] / weight[v] : 0.0;
  return sum;
}

PreparedFlow::PreparedFlow(const FlatFaces& faces, const VectorField& field, TauUnit unit, double tolerance,
                           const FieldError& error)
    : faces_(&faces), field_(&field), unit_(unit), tolerance_(tolerance), flowsOut_(mesh().halfedgeCount(), 0) {
  if (field.values.size() != static_cast<std::size_t>(mesh().vertexCount())) {
    throw InputError("the field of the tau map belongs to another mesh");
  }
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (std::isfinite(field.values[v].real()) && std::isfinite(field.values[v].imag())) continue;
    throw InputError(message("the vector at vertex ", v, " is not finite; give it a value"));
  }
  TraceOptions options;
  options.tolerance = tolerance;
  checkOptions(options);
  if (unit == TauUnit::Length) {
    slowSpeeds_ = slowSpeeds(field);
  } else {
    along_ = prepareFaces(faces, SteadyFlow(field.values.data(), rateOf(Direction::Forward)));
    against_ = prepareFaces(faces, SteadyFlow(field.values.data(), rateOf(Direction::Backward)));
  }
  holdsFixedPoint_ = fixedPointFaces(field);
  measureFaces();
  checkError(mesh(), error);
  if (error.epsilon > 0.0)
    divergenceBound_ = std::make_unique<const DivergenceBound>(faces, field, unit, growth_, slowSpeeds_, error);
  for (Index h = 0; h < mesh().halfedgeCount(); ++h) {
    flowsOut_[h] = mesh().twin(h) == kNone && crossedOutwards(faces, field, h);
  }
}

/// Of the linear part of the field. At unit speed the gradient is that of the direction, and no contraction is counted.
void PreparedFlow::measureFaces() {
  growth_.resize(mesh().faceCount());
  divergence_.resize(mesh().faceCount());
  bending_.resize(mesh().faceCount());
  double sum = 0.0;
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    const FlatFace& face = (*faces_)[f];
    Complex alongX = 0.0, alongY = 0.0;
    double squaredSpeed = 0.0;
    for (int i = 0; i < 3; ++i) {
      const Complex v = face.carry(i, field_->values[face.vertex(i)]), gradient = face.gradient(i);
      alongX += gradient.real() * v;
      alongY += gradient.imag() * v;
      squaredSpeed += std::norm(v) / 3.0;
      if (unit_ == TauUnit::Length) squaredSpeed += slowSpeeds_[face.vertex(i)] * slowSpeeds_[face.vertex(i)] / 3.0;
    }
    const double divergence = alongX.real() + alongY.imag();
    const double stretch = std::hypot(alongX.real() - alongY.imag(), alongX.imag() + alongY.real());
    bending_[f] = std::sqrt(std::norm(alongX) + std::norm(alongY));
    growth_[f] = 0.5 * (divergence + stretch);
    divergence_[f] = divergence;
    if (unit_ == TauUnit::Length) {
      bending_[f] /= std::sqrt(std::max(squaredSpeed, 1e-300));
      growth_[f] = 0.5 * bending_[f];
      divergence_[f] = bending_[f];
    }
    sum += mesh().faceArea(f) * bending_[f];
  }
  stepTau_ = kTurnOfStep * mesh().totalArea() / sum;
}

std::unique_ptr<PointAdvector> PreparedFlow::advector(Direction direction, const Progress* progress) const {
  const double rate = rateOf(direction);
  const DivergenceBound* const parting = direction == Direction::Forward ? divergenceBound_.get() : nullptr;
  TraceOptions options;
  options.direction = direction;
  options.tolerance = tolerance_;
  if (unit_ == TauUnit::Time) {
    const auto& prepared = direction == Direction::Backward ? against_ : along_;
    return std::make_unique<FlowAdvector<SteadyFlow>>(*faces_, SteadyFlow(field_->values.data(), rate, prepared.get()),
                                                      options, parting, progress);
  }
  return std::make_unique<FlowAdvector<UnitSpeedFlow>>(
      *faces_, UnitSpeedFlow(field_->values.data(), slowSpeeds_.data(), rate), options, parting, progress);
}

}  // namespace stormfield
