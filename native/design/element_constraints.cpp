#include "design/element_constraints.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>

#include "design/detail/bifurcation_targets.h"
#include "design/detail/element_targets.h"
#include "design/detail/singular_targets.h"
#include "field/parameterized_field.h"

namespace stormfield {

namespace {

void throwContradiction(const std::vector<DesignElement>& elements, const Target& a, const Target& b, double lambda) {
  throw InputError(describe(elements[a.element]) + " and " + describe(elements[b.element]) +
                   " contradict each other at vertex " + std::to_string(a.vertex) + ", lambda " + shortNumber(lambda) +
                   ": move one away, make a radius smaller, or let them act at different lambda");
}

/// Whether elements of other types make room for it.
bool displacesOthers(const DesignElement& element) {
  return element.type == ElementType::Singular || element.type == ElementType::Bifurcation;
}

/// Throws InputError unless there are samples before and after each event, and in its reach.
void checkEvents(const std::vector<DesignElement>& elements, double step) {
  for (const DesignElement& element : elements) {
    if (element.type != ElementType::Bifurcation) continue;
    const double lambda = element.lambdas.front();
    if (lambda < step || lambda > 1.0 - step)
      throw InputError(describe(element) + " is at lambda " + shortNumber(lambda) +
                       ", less than one sample from the end of the range: move it inside, or solve more samples");
    if (element.reach < 2.0 * step)
      throw InputError(describe(element) + " has reach " + shortNumber(element.reach) +
                       ", less than two samples of lambda: make it longer, or solve more samples");
  }
}

/// Whether they share more of lambda than an end; their fading ends may overlap all the same.
bool actTogether(const DesignElement& a, const DesignElement& b) {
  const double first = std::max(a.lambdas.front(), b.lambdas.front());
  const double last = std::min(a.lambdas.back(), b.lambdas.back());
  const bool instant = a.lambdas.front() == a.lambdas.back() || b.lambdas.front() == b.lambdas.back();
  return first < last || (instant && first == last);
}

/// Cores of elements that are not singular must not ask for vectors more than a right angle apart; singular elements
/// have settled this among themselves. `group` holds the targets of one vertex.
void checkContradiction(const std::vector<DesignElement>& elements, const Target* begin, const Target* end,
                        double lambda) {
  for (const Target* a = begin; a != end; ++a)
    for (const Target* b = a + 1; b != end; ++b) {
      const bool bothSingular =
          elements[a->element].type == ElementType::Singular && elements[b->element].type == ElementType::Singular;
      const bool oneDisplaces =
          (a->cover > 0.0 || b->cover > 0.0) && !(elements[a->element].hard && elements[b->element].hard);
      if (a->element == b->element || !a->core || !b->core || bothSingular || oneDisplaces) continue;
      if (!actTogether(elements[a->element], elements[b->element])) continue;
      if ((a->value * std::conj(b->value)).real() < 0.0) throwContradiction(elements, *a, *b, lambda);
    }
}

/// Targets of one sample, checked and reduced to constraints.
class Sample {
 public:
  Sample(const std::vector<DesignElement>& elements, double lambda) : elements_(elements), lambda_(lambda) {}

  std::vector<Target> reduce(std::vector<Target> targets) const {
    std::stable_sort(targets.begin(), targets.end(),
                     [](const Target& a, const Target& b) { return a.vertex < b.vertex; });
    std::vector<Target> reduced;
    for (auto begin = targets.begin(); begin != targets.end();) {
      auto end = begin;
      while (end != targets.end() && end->vertex == begin->vertex) ++end;
      checkContradiction(elements_, &*begin, &*begin + (end - begin), lambda_);
      reduceVertex(begin, end, reduced);
      begin = end;
    }
    return reduced;
  }

 private:
  using Iterator = std::vector<Target>::iterator;

  void reduceVertex(Iterator begin, Iterator end, std::vector<Target>& reduced) const {
    double cover = 0.0;
    for (Iterator t = begin; t != end; ++t) cover = std::max(cover, t->cover);
    Target hard;
    for (Iterator t = begin; t != end; ++t) {
      const bool displaced = !displacesOthers(elements_[t->element]);
      if (displaced) t->weight *= (1.0 - std::min(cover, 1.0)) * (1.0 - std::min(cover, 1.0));
      if (!(t->weight > 0.0)) continue;
      if (!elements_[t->element].hard || !t->core) continue;
      hard.vertex = t->vertex;
      hard.element = hard.element == kNone ? t->element : hard.element;
      hard.value += t->weight * t->value;
      hard.weight += t->weight;
    }
    if (hard.weight > 0.0) {
      hard.value /= hard.weight;
      hard.weight = std::numeric_limits<double>::infinity();
      reduced.push_back(hard);
      return;
    }
    for (Iterator t = begin; t != end; ++t)
      if (t->weight > 0.0) reduced.push_back(*t);
  }

  const std::vector<DesignElement>& elements_;
  double lambda_;
};

}  // namespace

ConstraintSet elementConstraints(const std::shared_ptr<const VertexCharts>& charts,
                                 const std::vector<DesignElement>& given, const ElementOptions& options,
                                 Progress* progress, LogMapCache* kept) {
  checkElements(given);
  if (std::all_of(given.begin(), given.end(), [](const auto& element) { return element.type == ElementType::Brush; }))
    throw InputError("the design has only brush strokes for this field: add an element that they change");
  if (options.samples < 1)
    throw InputError("the design has " + std::to_string(options.samples) + " samples: give at least 1");
  const TriangleMesh& mesh = charts->mesh();
  const std::vector<Junction> junctions = findJunctions(given, mesh.meanEdgeLength());
  const std::vector<DesignElement> elements = joinedEnds(given, junctions);
  const ClosestPointQuery query(charts->meshPointer());
  tbb::enumerable_thread_specific<LogMapScratch> scratch([&] { return LogMapScratch(mesh); });

  const SingularTargets singular(*charts, query, elements, junctions, options.stiffness);
  const TargetContext context{*charts, query, options.stiffness, options.lambdaPerSecond};
  std::vector<std::unique_ptr<ElementTargets>> others;
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (elements[i].type != ElementType::Singular && elements[i].type != ElementType::Brush)
      others.push_back(makeTargets(context, elements[i], static_cast<Index>(i), scratch.local()));
  keepOrbitsApart(others);
  keepBifurcationsAlone(mesh, others, elements, query);

  const std::vector<double> lambdas = evenLambdas(options.samples);
  const double step = options.samples > 1 ? lambdas[1] : 1.0;
  checkEvents(elements, step);
  std::vector<std::vector<Target>> targets(lambdas.size());
  // Samples fail on their own, so that the fault that is reported does not depend on the threads.
  std::vector<std::exception_ptr> faults(lambdas.size());
  std::mutex reporting;
  std::size_t done = 0;
  // Entries take five times as much memory as unknowns: two and a half vectors of them at most.
  const std::size_t maxEntries = static_cast<std::size_t>(mesh.vertexCount()) / 2;
  if (kept) kept->start(lambdas.size());
  tbb::parallel_for(std::size_t{0}, lambdas.size(), [&](std::size_t j) {
    try {
      if (progress) progress->check();
      std::vector<Target> sample;
      LogMapScratch& own = scratch.local();
      own.useKept(kept ? &(*kept)[j] : nullptr);
      singular.addAt(lambdas[j], step, own, sample);
      for (const auto& other : others) other->addAt(lambdas[j], step, own, sample);
      if (kept) (*kept)[j].keepUsed(maxEntries);
      targets[j] = Sample(elements, lambdas[j]).reduce(std::move(sample));
      const std::lock_guard lock(reporting);
      if (progress) progress->report(static_cast<double>(++done) / static_cast<double>(lambdas.size()));
    } catch (...) {
      faults[j] = std::current_exception();
    }
  });
  for (const std::exception_ptr& fault : faults)
    if (fault) std::rethrow_exception(fault);

  ConstraintSet set;
  for (const DesignElement& element : elements) set.elementNames.push_back(element.name);
  for (std::size_t j = 0; j < targets.size(); ++j)
    for (const Target& t : targets[j]) set.add(t.vertex, static_cast<Index>(j), t.value, t.weight, t.element);
  return set;
}

}  // namespace stormfield
