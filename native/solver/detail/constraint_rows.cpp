#include "solver/detail/constraint_rows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/message.h"

namespace stormfield {
namespace {

/// Hard values closer than this fraction of their length are the same.
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

/// Reports the first two constraints in the row that contradict.
[[noreturn]] void contradiction(const ConstraintSet& constraints, const std::vector<Index>& rowOf, Index row,
                                Index samples) {
  std::map<Index, std::size_t> hard;  // by sample
  for (std::size_t b = 0;; ++b) {
    if (rowOf[constraints.vertex[b]] != row || !std::isinf(constraints.weight[b])) continue;
    const auto [first, isNew] = hard.emplace(constraints.sample[b], b);
    const std::size_t a = first->second;
    if (isNew || !differ(constraints.value[a], constraints.value[b])) continue;
    const Index j = constraints.sample[a];
    const double lambda = samples > 1 ? static_cast<double>(j) / (samples - 1) : 0.0;
    throw InputError(message(elementName(constraints, a), " and ", elementName(constraints, b),
                             " want different hard values at vertex ", constraints.vertex[a], " at lambda ", lambda,
                             " (sample ", j, "): move one of them or make it soft"));
  }
}

/// Sorts the entries of a row by sample and makes those of one sample one: hard before soft, soft ones added up.
/// Returns their number, nothing when two hard ones contradict.
std::optional<std::size_t> mergeSamples(ConstraintRows::Entry* first, ConstraintRows::Entry* last) {
  const auto bySample = [](const auto& a, const auto& b) { return a.sample < b.sample; };
  if (!std::is_sorted(first, last, bySample)) std::stable_sort(first, last, bySample);
  if (first == last) return 0;
  ConstraintRows::Entry* merged = first;
  for (const ConstraintRows::Entry* next = first + 1; next < last; ++next) {
    if (next->sample != merged->sample) {
      *++merged = *next;
    } else if (merged->hard()) {
      if (next->hard() && differ(merged->pull, next->pull)) return std::nullopt;
    } else if (next->hard()) {
      *merged = *next;
    } else {
      merged->weight += next->weight;
      merged->pull += next->pull;
    }
  }
  return merged + 1 - first;
}

}  // namespace

ConstraintRows constraintRows(const ConstraintSet& constraints, const std::vector<Index>& rowOf,
                              const std::vector<double>& mass, Index samples) {
  check(constraints, static_cast<Index>(rowOf.size()), samples);
  const std::size_t rows = mass.size();

  // Counted and put in their places by slices, which side by side leave them in the order they came in.
  constexpr std::size_t kSlices = 4;
  std::array<std::vector<std::size_t>, kSlices> place;  // per row: how many, then where the next one goes
  std::array<bool, kSlices> anyHard{};
  auto forSlices = [&](const auto& body) {
    tbb::parallel_for(std::size_t{0}, kSlices, [&](std::size_t slice) {
      const std::size_t end = constraints.size() * (slice + 1) / kSlices;
      for (std::size_t k = constraints.size() * slice / kSlices; k < end; ++k) {
        const Index row = rowOf[constraints.vertex[k]];
        if (row != kNone) body(slice, k, row);
      }
    });
  };
  for (auto& rowsOfSlice : place) rowsOfSlice.assign(rows, 0);
  forSlices([&](std::size_t slice, std::size_t, Index row) { ++place[slice][row]; });
  ConstraintRows result;
  result.start.reserve(rows);
  result.stop.reserve(rows);
  std::size_t total = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    result.start.push_back(total);
    for (auto& rowsOfSlice : place) total += std::exchange(rowsOfSlice[i], total);
    result.stop.push_back(total);
  }
  result.entries.resize(total);
  forSlices([&](std::size_t slice, std::size_t k, Index row) {
    const double weight = constraints.weight[k];
    const bool hard = std::isinf(weight);
    anyHard[slice] = anyHard[slice] || hard;
    result.entries[place[slice][row]++] = {constraints.sample[k], hard ? weight : weight * mass[row],
                                           hard ? constraints.value[k] : weight * mass[row] * constraints.value[k]};
  });
  result.anyHard = std::find(anyHard.begin(), anyHard.end(), true) != anyHard.end();

  // The first row in which two constraints contradict.
  std::atomic<std::size_t> faultyRow{rows};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 512), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      ConstraintRows::Entry* first = result.entries.data() + result.start[i];
      const auto count = mergeSamples(first, result.entries.data() + result.stop[i]);
      result.stop[i] = result.start[i] + count.value_or(0);
      std::size_t least = faultyRow;
      while (!count && i < least && !faultyRow.compare_exchange_weak(least, i)) {
      }
    }
  });
  if (faultyRow < rows) contradiction(constraints, rowOf, static_cast<Index>(faultyRow), samples);
  return result;
}

}  // namespace stormfield
