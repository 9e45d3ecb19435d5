// Cancelling by several edits, each of which is verified by itself, where no single change of the field was.
//
// The pairs of an interval that flow joins without a saddle in between are cancelled one after the other, until what
// remains is what the index asks for. A pair whose entities are far from each other is cancelled after one of them has been
// moved near to the other. The field at the end is verified against the first one, as that of a single edit is.
//
//   if (!cancelInSteps(task, interval, index, result)) cancelAfterMove(task, interval, index, result);
#pragma once

#include "edit/detail/cancel_search.h"

namespace stormfield {

/// Whether a field was verified, which then is in the result.
bool cancelInSteps(const EditTask& task, const Interval& interval, const ConleyIndex& index, EditResult& result);
/// For a saddle and a node or an orbit, which one of its separatrices joins.
bool cancelAfterMove(const EditTask& task, const Interval& interval, const ConleyIndex& index, EditResult& result);

}  // namespace stormfield
