#include "design/element.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <utility>

#include "base/error.h"

namespace stormfield {

namespace {

void checkPositive(const DesignElement& element, double value, const char* what) {
  if (!std::isfinite(value) || value <= 0.0)
    throw InputError(describe(element) + " has " + what + " " + shortNumber(value) + ": give a number above 0");
}

void checkPoints(const DesignElement& element) {
  const bool curve = element.type == ElementType::Streamline || element.type == ElementType::Pathline;
  const std::size_t least = curve ? 2 : 1;
  if (element.points.size() < least)
    throw InputError(describe(element) + " has " + std::to_string(element.points.size()) +
                     " points: it needs at least " + std::to_string(least));
  for (std::size_t i = 0; i < element.points.size(); ++i)
    if (!element.points[i].allFinite())
      throw InputError(describe(element) + " point " + std::to_string(i) + " is not finite: give three finite numbers");
  if (element.type != ElementType::Regular) return;
  if (element.points.size() > 2)
    throw InputError(describe(element) + " has " + std::to_string(element.points.size()) +
                     " points: a regular element is an arrow from its first point to its second");
  if (element.points.size() == 1 && !element.direction)
    throw InputError(describe(element) + " has no direction: add a second point or a direction");
  if (!(arrowOf(element).norm() > 0.0))
    throw InputError(describe(element) + " has an arrow of length 0: move its second point away from the first");
}

void checkLambdas(const DesignElement& element) {
  const std::size_t n = element.lambdas.size();
  const bool moves =
      element.points.size() > 1 && (element.type == ElementType::Singular || element.type == ElementType::Pathline);
  if (n == 0 || (n > 2 && n != element.points.size()))
    throw InputError(describe(element) + " has " + std::to_string(n) + " lambda values for " +
                     std::to_string(element.points.size()) + " points: give start and end, or one per point");
  for (std::size_t i = 0; i < n; ++i) {
    const double value = element.lambdas[i];
    if (!std::isfinite(value) || value < 0.0 || value > 1.0)
      throw InputError(describe(element) + " has lambda " + shortNumber(value) +
                       ", outside 0..1: move it into the range");
    if (i == 0) continue;
    const bool stays = !moves || (n == element.points.size() && element.points[i] == element.points[i - 1]);
    if (value < element.lambdas[i - 1] || (!stays && value == element.lambdas[i - 1]))
      throw InputError(describe(element) + " has lambda " + shortNumber(value) + " at point " + std::to_string(i) +
                       " after " + shortNumber(element.lambdas[i - 1]) + ": let lambda grow along it");
  }
  if (moves && (n == 1 || !(element.lambdas.back() > element.lambdas.front())))
    throw InputError(describe(element) + " moves along " + std::to_string(element.points.size()) +
                     " points at a single lambda: give a start and a later end");
  if (n > 2 && !moves)
    throw InputError(describe(element) + " does not move, but has " + std::to_string(n) +
                     " lambda values: give start and end");
}

}  // namespace

int poincareIndex(SingularKind kind) {
  return kind == SingularKind::Saddle ? -1 : 1;
}

Complex rotation(SingularKind kind) {
  const auto rotated = [](double eighths) { return std::polar(1.0, eighths * std::numbers::pi / 4.0); };
  switch (kind) {
    case SingularKind::Sink:
      return rotated(4);
    case SingularKind::VortexCcw:
      return rotated(2);
    case SingularKind::VortexCw:
      return rotated(-2);
    case SingularKind::SpiralInCcw:
      return rotated(3);
    case SingularKind::SpiralInCw:
      return rotated(-3);
    case SingularKind::SpiralOutCcw:
      return rotated(1);
    case SingularKind::SpiralOutCw:
      return rotated(-1);
    case SingularKind::Source:
    case SingularKind::Saddle:
      break;
  }
  return 1.0;
}

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string describe(const DesignElement& element) {
  switch (element.type) {
    case ElementType::Singular:
      return "singular element \"" + element.name + "\"";
    case ElementType::Regular:
      return "regular element \"" + element.name + "\"";
    case ElementType::Streamline:
    case ElementType::Pathline:
      break;
  }
  return "curve \"" + element.name + "\"";
}

Vec3 arrowOf(const DesignElement& element) {
  return element.points.size() == 2 ? Vec3(element.points[1] - element.points[0]) : *element.direction;
}

void checkElements(const std::vector<DesignElement>& elements) {
  if (elements.empty()) throw InputError("the design has no element for this field: add one or enable one");
  std::set<std::string> names;
  for (const DesignElement& element : elements) {
    if (!names.insert(element.name).second)
      throw InputError("two elements are named \"" + element.name + "\": give each its own name");
    checkPoints(element);
    checkLambdas(element);
    checkPositive(element, element.radius, "radius");
    checkPositive(element, element.strength, "strength");
    if (!std::isfinite(element.angle)) throw InputError(describe(element) + " has an angle that is not finite");
    if (element.direction && !element.direction->allFinite())
      throw InputError(describe(element) + " has a direction that is not finite: give three finite numbers");
  }
}

}  // namespace stormfield
