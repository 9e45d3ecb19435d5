#include "edit/cancel.h"

#include "edit/detail/cancel_search.h"
#include "edit/detail/cancel_steps.h"
#include "edit/detail/interval_index.h"
#include "edit/entity_names.h"

namespace stormfield {

CancelPlan planCancel(const VectorField& field, const Topology& topology, const EntityRef& a, const EntityRef& b,
                      const CancelOptions& options) {
  CancelPlan plan;
  plan.interval = findInterval(topology, field.mesh(), a, b);
  plan.index = intervalIndex(topology, plan.interval);
  plan.left = fewestContents(plan.index);
  BlockSequence blocks(field, topology, plan.interval, plan.index, options.maxRings);
  const Block* block = blocks.at(0);
  if (block == nullptr) throw InputError(noRoom(field.mesh(), topology, plan.interval));
  plan.faces = block->faces;
  return plan;
}

EditResult cancelPair(const FlatFaces& faces, const VectorField& field, const Topology& topology, const EntityRef& a,
                      const EntityRef& b, const CancelOptions& options, Progress* progress) {
  EditResult result;
  result.field = field;
  try {
    requireFinite(field);
    const EditTask task{faces, field, topology, options, progress};
    const Interval interval = findInterval(topology, field.mesh(), a, b);
    const ConleyIndex index = intervalIndex(topology, interval);
    result.index = index;
    CancelSearch search(task, interval, index);
    const bool found = search.run(result) || (options.inSteps && (cancelInSteps(task, interval, index, result) ||
                                                                  cancelAfterMove(task, interval, index, result)));
    if (!found) result.reason = search.reason();
  } catch (const InputError& fault) {
    result.reason = fault.what();
  }
  if (!result.applied) result.topology = topology;
  return result;
}

}  // namespace stormfield
