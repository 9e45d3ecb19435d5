#include "design/detail/junction.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace stormfield {

namespace {

// Lambda values of drawn curves come from single precision sliders.
constexpr double kSameLambda = 1e-3;

struct PathEnd {
  Index element = kNone;
  bool starts = false;
  double lambda = 0.0;
  Vec3 point = Vec3::Zero();
  bool used = false;
};

std::vector<PathEnd> innerEnds(const std::vector<DesignElement>& elements) {
  std::vector<PathEnd> ends;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const DesignElement& element = elements[i];
    if (element.type != ElementType::Singular) continue;
    const Index index = static_cast<Index>(i);
    if (element.lambdas.front() > kSameLambda)
      ends.push_back({index, true, element.lambdas.front(), element.points.front()});
    if (element.lambdas.back() < 1.0 - kSameLambda)
      ends.push_back({index, false, element.lambdas.back(), element.points.back()});
  }
  return ends;
}

std::string names(const std::vector<DesignElement>& elements, const Junction& junction) {
  std::string text;
  for (const auto* side : {&junction.ending, &junction.starting})
    for (const Index i : *side) text += (text.empty() ? "\"" : ", \"") + elements[i].name + "\"";
  return text;
}

void classify(const std::vector<DesignElement>& elements, Junction& junction) {
  const std::size_t ending = junction.ending.size(), starting = junction.starting.size();
  if (ending + starting > 3)
    throw InputError("the singular elements " + names(elements, junction) + " meet at lambda " +
                     shortNumber(junction.lambda) + ": let two of them merge or split there, and the others later");
  junction.kind = ending == 2     ? Junction::Kind::Merge
                  : starting == 2 ? Junction::Kind::Split
                                  : Junction::Kind::Continuation;
  const std::vector<Index>& single = ending == 1 ? junction.ending : junction.starting;
  const DesignElement& one = elements[single.front()];
  junction.point = ending == 1 ? one.points.back() : one.points.front();
  if (junction.kind == Junction::Kind::Continuation) return;
  for (const auto* side : {&junction.ending, &junction.starting})
    for (const Index i : *side)
      if (elements[i].kind == SingularKind::Saddle)
        throw InputError("the saddle \"" + elements[i].name + "\" takes part in the merge or split of " +
                         names(elements, junction) + ": join sources, sinks, vortices or spirals only");
  const std::vector<Index>& pair = junction.pair();
  if ((rotation(elements[pair[0]].kind) / rotation(elements[pair[1]].kind)).real() < -0.9)
    throw InputError("\"" + elements[pair[0]].name + "\" and \"" + elements[pair[1]].name +
                     "\" are joined but opposite: give both the same kind");
}

}  // namespace

std::vector<Junction> findJunctions(const std::vector<DesignElement>& elements, double meanEdgeLength) {
  std::vector<PathEnd> ends = innerEnds(elements);
  std::vector<Junction> junctions;
  for (PathEnd& seed : ends) {
    if (seed.used) continue;
    Junction junction;
    junction.lambda = seed.lambda;
    std::vector<PathEnd*> members;
    for (PathEnd& end : ends) {
      const double radius =
          std::min(radiusAt(elements[seed.element], seed.lambda), radiusAt(elements[end.element], end.lambda));
      const bool isSeed = &end == &seed;
      if (!isSeed && (end.used || end.element == seed.element || std::abs(end.lambda - seed.lambda) > kSameLambda ||
                      (end.point - seed.point).norm() > std::max(meanEdgeLength, 0.25 * radius)))
        continue;
      (end.starts ? junction.starting : junction.ending).push_back(end.element);
      members.push_back(&end);
    }
    if (junction.ending.empty() || junction.starting.empty()) continue;
    classify(elements, junction);
    for (PathEnd* end : members) end->used = true;
    junctions.push_back(std::move(junction));
  }
  return junctions;
}

std::vector<DesignElement> joinedEnds(std::vector<DesignElement> elements, const std::vector<Junction>& junctions) {
  for (const Junction& junction : junctions) {
    for (const Index i : junction.ending) {
      if (elements[i].points.size() > 1) elements[i].points.back() = junction.point;
      elements[i].lambdas.back() = junction.lambda;
    }
    for (const Index i : junction.starting) {
      if (elements[i].points.size() > 1) elements[i].points.front() = junction.point;
      elements[i].lambdas.front() = junction.lambda;
    }
  }
  return elements;
}

}  // namespace stormfield
