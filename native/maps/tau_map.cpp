#include "maps/tau_map.h"

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/memory_limit.h"
#include "base/message.h"
#include "maps/error_bound.h"
#include "maps/geometry_map.h"
#include "maps/tau_rows.h"

namespace stormfield {
namespace {

/// Faces whose rows are computed beforehand to estimate the size of F.
constexpr Index kPilotFaces = 256;
/// Bytes at the peak: measured for the work around a face; an edge of F is held twice while rows are joined.
constexpr double kBytesPerFace = 120.0, kBytesPerEdge = 2.0 * sizeof(Index);

const char* unitName(TauUnit unit) {
  return unit == TauUnit::Time ? " s" : " mesh units";
}

/// Faces with the same tau are computed together.
std::map<double, std::vector<Index>> groupFaces(const std::vector<double>& taus) {
  std::map<double, std::vector<Index>> groups;
  for (std::size_t f = 0; f < taus.size(); ++f) {
    if (!(taus[f] >= 0.0 && std::isfinite(taus[f]))) {
      throw InputError(message("the tau of face ", f, " is ", taus[f], "; it must be a positive number"));
    }
    groups[taus[f]].push_back(static_cast<Index>(f));
  }
  return groups;
}

/// Bytes that a tau map needs at the peak, from the rows of some of its faces.
double estimatedBytes(const PreparedFlow& flow, const std::vector<Index>& pilot, double tau, std::size_t limit,
                      Progress* progress) {
  const auto faceCount = static_cast<double>(flow.mesh().faceCount());
  const TauRows rows = tauRows(flow, pilot, tau, limit, progress);
  const double edgesPerFace = static_cast<double>(rows.targets.size()) / static_cast<double>(pilot.size());
  return faceCount * (kBytesPerFace + kBytesPerEdge * edgesPerFace);
}

/// Throws InputError naming the largest tau that fits, when this one does not.
void checkMemory(const PreparedFlow& flow, double tau, std::size_t limit, Progress* progress) {
  const auto faceCount = static_cast<double>(flow.mesh().faceCount());
  if (faceCount * (kBytesPerFace + kBytesPerEdge * (faceCount + 1.0)) <= static_cast<double>(limit)) return;
  const Index count = std::min(kPilotFaces, flow.mesh().faceCount());
  std::vector<Index> pilot(count);
  for (Index i = 0; i < count; ++i) {
    pilot[i] = static_cast<Index>(static_cast<std::int64_t>(i) * flow.mesh().faceCount() / count);
  }
  const auto fits = [&](double t) {
    return estimatedBytes(flow, pilot, t, std::numeric_limits<std::size_t>::max(), progress) <=
           static_cast<double>(limit);
  };
  if (fits(tau)) return;
  double low = 0.0, high = tau;
  for (int i = 0; i < 40 && low < 0.9 * high; ++i) {
    const double middle = low > 0.0 ? 0.5 * (low + high) : 0.25 * high;
    (fits(middle) ? low : high) = middle;
  }
  const std::string cure = low > 0.0
                               ? message("the largest tau that fits is about ", low, unitName(flow.unit()))
                               : std::string("not even a small tau fits: allow more memory or use a coarser mesh");
  throw InputError(message("the map of tau = ", tau, unitName(flow.unit()), " would need more than ", limit >> 20,
                           " MiB of memory; ", cure));
}

}  // namespace

CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, double tau, const TauMapOptions& options,
                        Progress* progress, TauWork* work) {
  if (!(tau > 0.0 && std::isfinite(tau))) {
    throw InputError(message("tau is ", tau, "; it must be a positive number of", unitName(options.unit)));
  }
  return tauMap(faces, field, std::vector<double>(static_cast<std::size_t>(faces.mesh().faceCount()), tau), options,
                progress, work);
}

CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, const std::vector<double>& taus,
                        const TauMapOptions& options, Progress* progress, TauWork* work) {
  const Index faceCount = faces.mesh().faceCount();
  if (taus.size() != static_cast<std::size_t>(faceCount)) {
    throw InputError(message("there are ", taus.size(), " values of tau for ", faceCount, " faces; give one for each"));
  }
  auto groups = groupFaces(taus);
  if (options.error.epsilon > 0.0 && groups.contains(0.0)) {
    throw InputError("an error bound needs a tau > 0 on every face; rows of the geometry-based map have their own");
  }
  const PreparedFlow flow(faces, field, options.unit, options.tolerance, options.error);
  const std::size_t limit = options.memoryLimit.value_or(halfOfMemory());
  checkMemory(flow, groups.rbegin()->first, limit, progress);

  CombinatorialMap geometry;
  std::vector<RowGroup> rowGroups;
  std::size_t done = 0;
  for (auto& [tau, members] : groups) {
    const auto fraction = [&] { return static_cast<double>(done) / static_cast<double>(faceCount); };
    const double from = fraction();
    done += members.size();
    if (progress != nullptr) progress->range(from, fraction());
    if (tau == 0.0) geometry = geometryMap(field);
    TauRows rows = tau > 0.0 ? tauRows(flow, members, tau, limit, progress, work) : geometryRows(geometry, members);
    rowGroups.push_back({std::move(members), std::move(rows)});
  }
  return mapFromRowGroups(faceCount, std::move(rowGroups));
}

double startingTau(const VectorField& field, TauUnit unit, double edges) {
  if (!(edges > 0.0 && std::isfinite(edges))) {
    throw InputError(message("a tau for ", edges, " edges was asked for; give a positive number"));
  }
  const double length = edges * field.mesh().meanEdgeLength();
  if (unit == TauUnit::Length) return length;
  const double speed = meanSpeed(field);
  if (!(speed > 0.0)) throw InputError("the field is zero everywhere: no tau takes anything from its place");
  return length / speed;
}

}  // namespace stormfield
