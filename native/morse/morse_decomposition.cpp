#include "morse/morse_decomposition.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/message.h"
#include "field/poincare_index.h"
#include "maps/fixed_point_faces.h"
#include "morse/detail/exit_set.h"
#include "morse/recurrence.h"

namespace stormfield {
namespace {

void checkSize(std::size_t size, Index faces, const char* what) {
  if (size == static_cast<std::size_t>(faces)) return;
  throw InputError(message(what, " has ", size, " faces, but the mesh has ", faces, "; make it on the same mesh"));
}

/// The sets that are chosen, in their order.
FaceSets chosen(const FaceSets& sets, const std::vector<char>& isChosen) {
  std::vector<Index> number(sets.count(), kNone);
  Index count = 0;
  for (Index s = 0; s < sets.count(); ++s) {
    if (isChosen[s] != 0) number[s] = count++;
  }
  std::vector<Index> setOf = sets.setOf();
  for (Index& set : setOf) set = set == kNone ? kNone : number[set];
  return {std::move(setOf), count};
}

bool meetsBoundary(const TriangleMesh& mesh, const std::vector<Index>& faces) {
  return std::any_of(faces.begin(), faces.end(), [&](Index f) {
    return mesh.isBoundaryVertex(mesh.vertex(f, 0)) || mesh.isBoundaryVertex(mesh.vertex(f, 1)) ||
           mesh.isBoundaryVertex(mesh.vertex(f, 2));
  });
}

std::vector<MorseSet> morseSets(const VectorField& field, const CombinatorialMap& map, const std::vector<char>& mapped,
                                const FaceSets& faces, const Progress& progress) {
  const std::vector<int> poincare = poincareIndices(field);
  std::vector<MorseSet> sets(faces.count());
  tbb::parallel_for(Index{0}, faces.count(), [&](Index s) {
    if (!progress.cancelled()) sets[s] = morseSet(field, map, poincare, mapped, faces, s);
  });
  return sets;
}

void dropTrivial(MorseDecomposition& morse) {
  const auto isTrivial = [](const MorseSet& set) { return set.kind == MorseKind::Trivial; };
  std::vector<char> kept;
  for (const MorseSet& set : morse.sets) kept.push_back(isTrivial(set) ? 0 : 1);
  morse.faces = chosen(morse.faces, kept);
  std::erase_if(morse.sets, isTrivial);
}

}  // namespace

FaceSets recurrentSets(const CombinatorialMap& map, const Components& components) {
  std::vector<Index> number(components.count(), kNone), setOf(map.outside(), kNone);
  Index count = 0;
  for (Index f = 0; f < map.outside(); ++f) {
    const Index component = components.of[f];
    if (components.recurrent[component] == 0) continue;
    if (number[component] == kNone) number[component] = count++;
    setOf[f] = number[component];
  }
  return {std::move(setOf), count};
}

MorseSet morseSet(const VectorField& field, const CombinatorialMap& map, const std::vector<int>& poincare,
                  const std::vector<char>& mapped, const FaceSets& faces, Index set) {
  MorseSet result;
  for (const Index f : faces.members(set)) {
    result.poincare += poincare[f];
    result.upperBound = result.upperBound || (!mapped.empty() && mapped[f] != 0);
  }
  const IndexPair pair = result.upperBound ? mapPair(field, map, faces, set) : flowPair(field, map, faces, set);
  result.index = conleyIndex(field.mesh(), faces, set, pair);
  if (!result.upperBound) {
    result.internalTangencies = internalTangencies(field, faces, set);
  } else if (!meetsBoundary(field.mesh(), faces.members(set))) {
    // At the boundary of the surface the flow may touch it from inside, and the sum is another one.
    result.index = matchPoincareSum(result.index, result.poincare);
  }
  result.kind = kindOf(result.index);
  return result;
}

MorseDecomposition morseDecomposition(const VectorField& field, const CombinatorialMap& map,
                                      const MorseOptions& options, Progress& progress) {
  const TriangleMesh& mesh = field.mesh();
  checkSize(static_cast<std::size_t>(map.outside()), mesh.faceCount(), "the combinatorial map");
  if (!options.mapped.empty()) checkSize(options.mapped.size(), mesh.faceCount(), "the list of mapped faces");
  if (options.fixedPointFaces) {
    checkSize(options.fixedPointFaces->size(), mesh.faceCount(), "the list of faces with fixed points");
  }

  const Components components = stronglyConnectedComponents(map.graph);
  progress.report(0.3);
  progress.check();
  const FaceSets recurrent = recurrentSets(map, components);
  const std::vector<char> kept =
      options.kept.empty
          ? std::vector<char>(recurrent.count(), 1)
          : canRecur(mesh, recurrent, options.fixedPointFaces ? *options.fixedPointFaces : fixedPointFaces(field));
  progress.report(0.5);
  progress.check();

  MorseDecomposition result;
  result.mapEdges = map.graph.edgeCount();
  result.faces = chosen(recurrent, kept);
  result.sets = morseSets(field, map, options.mapped, result.faces, progress);
  if (!options.kept.trivial) dropTrivial(result);
  progress.report(0.7);
  progress.check();
  result.graph = morseConnectionGraph(map, components, result.faces);
  progress.report(1.0);
  return result;
}

}  // namespace stormfield
