#include "design/element.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <utility>

#include "base/error.h"

namespace stormfield {

namespace {

void checkCount(const DesignElement& element, const OverLambda& number, const char* what) {
  const std::size_t count = number.values().size(), wanted = element.lambdas.size();
  if (count == 1 || count == wanted) return;
  throw InputError(describe(element) + " has " + std::to_string(count) + " values of " + what + " for " +
                   std::to_string(wanted) + " lambda values: give one number, or one per lambda value");
}

void checkPositive(const DesignElement& element, const OverLambda& number, const char* what) {
  checkCount(element, number, what);
  for (const double value : number.values())
    if (!std::isfinite(value) || value <= 0.0)
      throw InputError(describe(element) + " has " + what + " " + shortNumber(value) + ": give a number above 0");
}

void checkStrength(const DesignElement& element) {
  if (element.strength.values().size() == 1) return checkPositive(element, element.strength, "strength");
  checkCount(element, element.strength, "strength");
  for (const double value : element.strength.values()) {
    if (!std::isfinite(value)) throw InputError(describe(element) + " has a strength that is not finite");
    if (value < 0.0)
      throw InputError(describe(element) + " has strength " + shortNumber(value) +
                       ": a strength never falls below 0; end the element where it is 0 and begin its opposite there");
  }
  if (!(element.strength.largest() > 0.0))
    throw InputError(describe(element) + " has strength 0 at every lambda: give a number above 0 somewhere");
}

void checkFinite(const DesignElement& element, const OverLambda& number, const char* what) {
  checkCount(element, number, what);
  for (const double value : number.values())
    if (!std::isfinite(value)) throw InputError(describe(element) + " has " + what + " that is not finite");
}

void checkRate(const DesignElement& element) {
  const bool orbit = element.type == ElementType::Orbit;
  checkFinite(element, element.rate, orbit ? "a pull" : "a rate");
  if (element.rate.least() < 0.0 || (orbit && element.rate.least() == 0.0))
    throw InputError(describe(element) + " has " + (orbit ? "pull " : "rate ") + shortNumber(element.rate.least()) +
                     ": give " +
                     (orbit ? "a number above 0, and choose attracting or repelling"
                            : "0 or more, and choose attachment or separation"));
}

void checkBifurcation(const DesignElement& element) {
  if (element.type != ElementType::Bifurcation) return;
  if (element.points.size() != 1 || element.lambdas.size() != 1)
    throw InputError(describe(element) + " has " + std::to_string(element.points.size()) + " points and " +
                     std::to_string(element.lambdas.size()) + " lambda values: it happens at one point and one lambda");
  const double lambda = element.lambdas.front();
  if (!(lambda > 0.0 && lambda < 1.0))
    throw InputError(describe(element) + " is at lambda " + shortNumber(lambda) +
                     ", the end of the range: move it inside, so that there is a before and an after");
  if (!(element.reach > 0.0 && element.reach <= 1.0))
    throw InputError(describe(element) + " has reach " + shortNumber(element.reach) +
                     ": give a length of lambda above 0, and at most 1");
}

void checkFades(const DesignElement& element) {
  for (const double fade : {element.fadeIn, element.fadeOut})
    if (!(fade >= 0.0 && fade <= 1.0))
      throw InputError(describe(element) + " fades over " + shortNumber(fade) + " of lambda: give 0 to 1");
  const double fades = element.fadeIn + element.fadeOut;
  const double life = element.lambdas.back() - element.lambdas.front();
  if (fades > 0.0 && fades > life * (1.0 + 1e-9))
    throw InputError(describe(element) + " fades over " + shortNumber(fades) + " of lambda, but lives for " +
                     shortNumber(life) + ": make its fades shorter");
}

bool isArrow(const DesignElement& element) {
  const bool either = element.type == ElementType::Attachment || element.type == ElementType::Separation;
  return element.type == ElementType::Regular || (either && element.points.size() == 1);
}

void checkPoints(const DesignElement& element) {
  const std::size_t least = element.type == ElementType::Orbit ? 3 : isCurve(element) ? 2 : 1;
  if (element.points.size() < least)
    throw InputError(describe(element) + " has " + std::to_string(element.points.size()) +
                     " points: it needs at least " + std::to_string(least));
  for (std::size_t i = 0; i < element.points.size(); ++i)
    if (!element.points[i].allFinite())
      throw InputError(describe(element) + " point " + std::to_string(i) + " is not finite: give three finite numbers");
  if (!isArrow(element)) return;
  if (element.points.size() > 2)
    throw InputError(describe(element) + " has " + std::to_string(element.points.size()) +
                     " points: a regular element is an arrow from its first point to its second");
  if (element.points.size() == 1 && !element.direction)
    throw InputError(describe(element) + " has no direction: add a second point or a direction");
  if (!(arrowOf(element).norm() > 0.0))
    throw InputError(describe(element) + " has an arrow of length 0: move its second point away from the first");
}

bool hasLists(const DesignElement& element) {
  for (const OverLambda* number : {&element.strength, &element.radius, &element.angle, &element.rate})
    if (number->values().size() > 1) return true;
  return false;
}

void checkLambdas(const DesignElement& element) {
  const std::size_t n = element.lambdas.size();
  const bool moving = moves(element);
  if (n == 0 || (n > 2 && n != element.points.size() && (moving || !hasLists(element))))
    throw InputError(describe(element) + " has " + std::to_string(n) + " lambda values for " +
                     std::to_string(element.points.size()) + " points: give start and end, or one per point");
  for (std::size_t i = 0; i < n; ++i) {
    const double value = element.lambdas[i];
    if (!std::isfinite(value) || value < 0.0 || value > 1.0)
      throw InputError(describe(element) + " has lambda " + shortNumber(value) +
                       ", outside 0..1: move it into the range");
    if (i == 0) continue;
    const bool stays = !moving || (n == element.points.size() && element.points[i] == element.points[i - 1]);
    if (value < element.lambdas[i - 1] || (!stays && value == element.lambdas[i - 1]))
      throw InputError(describe(element) + " has lambda " + shortNumber(value) + " at point " + std::to_string(i) +
                       " after " + shortNumber(element.lambdas[i - 1]) + ": let lambda grow along it");
  }
  if (moving && (n == 1 || !(element.lambdas.back() > element.lambdas.front())))
    throw InputError(describe(element) + " moves along " + std::to_string(element.points.size()) +
                     " points at a single lambda: give a start and a later end");
  if (n > 2 && !moving && !hasLists(element))
    throw InputError(describe(element) + " does not move, but has " + std::to_string(n) +
                     " lambda values: give start and end");
}

}  // namespace

double OverLambda::at(const std::vector<double>& lambdas, double lambda) const {
  if (values_.size() == 1 || lambda <= lambdas.front()) return values_.front();
  if (lambda >= lambdas.back()) return values_.back();
  const std::size_t k = std::upper_bound(lambdas.begin(), lambdas.end(), lambda) - lambdas.begin();
  const double fraction = (lambda - lambdas[k - 1]) / (lambdas[k] - lambdas[k - 1]);
  return values_[k - 1] + fraction * (values_[k] - values_[k - 1]);
}

double OverLambda::least() const {
  return *std::min_element(values_.begin(), values_.end());
}

double OverLambda::largest() const {
  return *std::max_element(values_.begin(), values_.end());
}

bool isCurve(const DesignElement& element) {
  switch (element.type) {
    case ElementType::Streamline:
    case ElementType::Pathline:
    case ElementType::Orbit:
    case ElementType::Brush:
      return true;
    case ElementType::Attachment:
    case ElementType::Separation:
      return element.points.size() > 1;
    case ElementType::Singular:
    case ElementType::Regular:
    case ElementType::Bifurcation:
      break;
  }
  return false;
}

bool moves(const DesignElement& element) {
  return element.points.size() > 1 && (element.type == ElementType::Singular || element.type == ElementType::Pathline);
}

double signedRateAt(const DesignElement& element, double lambda) {
  const double rate = element.rate.at(element.lambdas, lambda);
  if (element.type == ElementType::Separation) return rate;
  if (element.type == ElementType::Attachment) return -rate;
  if (element.type == ElementType::Orbit) return element.stability == OrbitStability::Attracting ? -rate : rate;
  return 0.0;
}

double strengthAt(const DesignElement& element, double lambda) {
  const auto fade = [](double past, double length) { return length > 0.0 ? std::clamp(past / length, 0.0, 1.0) : 1.0; };
  const double grown = fade(lambda - element.lambdas.front(), element.fadeIn);
  const double left = fade(element.lambdas.back() - lambda, element.fadeOut);
  return element.strength.at(element.lambdas, lambda) * grown * left;
}

double holdAt(const DesignElement& element, double lambda) {
  const double relative = strengthAt(element, lambda) / element.strength.largest();
  return relative * relative;
}

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
    case ElementType::Attachment:
    case ElementType::Separation:
    case ElementType::Orbit:
    case ElementType::Bifurcation:
    case ElementType::Brush:
      return std::string(name(element.type)) + " \"" + element.name + "\"";
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
    checkStrength(element);
    checkFinite(element, element.angle, "an angle");
    checkRate(element);
    checkFades(element);
    checkBifurcation(element);
    if (!(element.falloff >= 0.0 && element.falloff <= 1.0))
      throw InputError(describe(element) + " has falloff " + shortNumber(element.falloff) + ": give 0 to 1");
    if (element.direction && !element.direction->allFinite())
      throw InputError(describe(element) + " has a direction that is not finite: give three finite numbers");
  }
}

}  // namespace stormfield
