#include "design/constraint_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/message.h"

namespace stormfield {
namespace {

/// Hard values closer than this part of their length are the same.
constexpr double kSameValue = 1e-9;

std::string elementName(const ConstraintSet& constraints, std::size_t k) {
  if (k < constraints.element.size()) {
    const Index element = constraints.element[k];
    if (element >= 0 && element < static_cast<Index>(constraints.elementNames.size())) {
      return "element '" + constraints.elementNames[element] + "'";
    }
    return message("element ", element);
  }
  return "an unnamed element";
}

void check(const ConstraintSet& constraints, Index vertices, Index samples) {
  const std::size_t n = constraints.size();
  if (n == 0) {
    throw InputError(
        "the design has no constraint, so the field would be zero: add an element, or enlarge the radius of "
        "those there until they reach a vertex");
  }
  if (constraints.sample.size() != n || constraints.value.size() != n || constraints.weight.size() != n ||
      constraints.element.size() != n) {
    throw InputError("the arrays of a ConstraintSet must have the same length");
  }
  for (std::size_t k = 0; k < n; ++k) {
    const Index v = constraints.vertex[k];
    const Index j = constraints.sample[k];
    auto fail = [&](const std::string& what) {
      throw InputError(message(elementName(constraints, k), ": constraint ", k, " ", what));
    };
    if (v < 0 || v >= vertices) fail(message("is at vertex ", v, ", but the mesh has vertices 0 to ", vertices - 1));
    if (j < 0 || j >= samples) fail(message("is at lambda sample ", j, ", but samples are 0 to ", samples - 1));
    const Complex value = constraints.value[k];
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) {
      fail(message("at vertex ", v, " has a value that is not finite"));
    }
    if (!(constraints.weight[k] > 0.0)) {
      fail(message("at vertex ", v, " has the weight ", constraints.weight[k], ": give a weight above zero"));
    }
  }
}

[[noreturn]] void contradiction(const ConstraintSet& constraints, std::size_t a, std::size_t b, Index samples) {
  const Index j = constraints.sample[a];
  const double lambda = samples > 1 ? static_cast<double>(j) / (samples - 1) : 0.0;
  throw InputError(message(elementName(constraints, a), " and ", elementName(constraints, b),
                           " want different hard values at vertex ", constraints.vertex[a], " at lambda ", lambda,
                           " (sample ", j, "): move one of them or make it soft"));
}

}  // namespace

ConstraintRows constraintRows(const ConstraintSet& constraints, const std::vector<Index>& rowOf,
                              const std::vector<double>& mass, Index samples) {
  check(constraints, static_cast<Index>(rowOf.size()), samples);
  const std::size_t rows = mass.size();

  std::vector<std::size_t> start(rows + 1, 0);
  for (const Index v : constraints.vertex) {
    if (rowOf[v] != kNone) ++start[rowOf[v] + 1];
  }
  for (std::size_t i = 0; i < rows; ++i) start[i + 1] += start[i];
  std::vector<std::size_t> sorted(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    if (rowOf[constraints.vertex[k]] != kNone) sorted[next[rowOf[constraints.vertex[k]]]++] = k;
  }

  ConstraintRows result;
  result.start.reserve(rows + 1);
  result.entries.reserve(sorted.size());
  const auto bySample = [&](std::size_t a, std::size_t b) { return constraints.sample[a] < constraints.sample[b]; };
  for (std::size_t i = 0; i < rows; ++i) {
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(start[i]);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(start[i + 1]);
    if (!std::is_sorted(first, last, bySample)) std::stable_sort(first, last, bySample);
    std::size_t hardBefore = 0;
    for (auto it = first; it != last; ++it) {
      const std::size_t k = *it;
      const Index j = constraints.sample[k];
      const Complex value = constraints.value[k];
      const bool hard = std::isinf(constraints.weight[k]);
      if (it == first || result.entries.back().sample != j) {
        result.entries.push_back({j, 0.0, 0.0});
      }
      ConstraintRows::Entry& entry = result.entries.back();
      if (hard) {
        const double length = std::max(std::abs(value), std::abs(entry.pull));
        if (entry.hard() && std::abs(entry.pull - value) > kSameValue * length) {
          contradiction(constraints, hardBefore, k, samples);
        }
        entry.weight = constraints.weight[k];
        entry.pull = value;
        hardBefore = k;
        result.anyHard = true;
      } else if (!entry.hard()) {
        entry.weight += constraints.weight[k] * mass[i];
        entry.pull += constraints.weight[k] * mass[i] * value;
      }
    }
    result.start.push_back(result.entries.size());
  }
  return result;
}

}  // namespace stormfield
