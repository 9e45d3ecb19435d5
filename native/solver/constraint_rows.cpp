#include "solver/constraint_rows.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/message.h"

namespace stormfield {
namespace {

/// Hard values closer than this part of their length are the same.
constexpr double kSameValue = 1e-9;

bool differ(Complex a, Complex b) {
  return std::abs(a - b) > kSameValue * std::max(std::abs(a), std::abs(b));
}

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
  result.start.assign(start.begin(), start.end() - 1);
  result.stop.resize(rows);
  result.entries.resize(sorted.size());
  // Two constraints that contradict, of the first row that has any.
  std::pair<std::size_t, std::size_t> fault;
  std::atomic<std::size_t> faultyRow{rows};
  std::atomic<bool> anyHard{false};
  std::mutex faultMutex;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 512), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(start[i]);
      const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(start[i + 1]);
      const auto bySample = [&](std::size_t a, std::size_t b) { return constraints.sample[a] < constraints.sample[b]; };
      if (!std::is_sorted(first, last, bySample)) std::stable_sort(first, last, bySample);
      std::size_t count = start[i];
      std::size_t hardBefore = 0;
      for (auto it = first; it != last; ++it) {
        const std::size_t k = *it;
        const bool hard = std::isinf(constraints.weight[k]);
        if (it == first || result.entries[count - 1].sample != constraints.sample[k]) {
          result.entries[count++] = {constraints.sample[k], 0.0, 0.0};
        }
        ConstraintRows::Entry& entry = result.entries[count - 1];
        if (hard) {
          if (entry.hard() && differ(entry.pull, constraints.value[k])) {
            const std::lock_guard lock(faultMutex);
            if (i < faultyRow) {
              faultyRow = i;
              fault = {hardBefore, k};
            }
          }
          entry.weight = constraints.weight[k];
          entry.pull = constraints.value[k];
          hardBefore = k;
          anyHard = true;
        } else if (!entry.hard()) {
          entry.weight += constraints.weight[k] * mass[i];
          entry.pull += constraints.weight[k] * mass[i] * constraints.value[k];
        }
      }
      result.stop[i] = count;
    }
  });
  if (faultyRow < rows) contradiction(constraints, fault.first, fault.second, samples);
  result.anyHard = anyHard;
  return result;
}

}  // namespace stormfield
