// An order of the vertices for Gauss-Seidel sweeps that run in parallel and give the same bits on any thread count.
//
// Vertices near each other form chunks; the chunks are coloured so that chunks of one colour share no edge. Rows are
// renumbered by colour, then chunk: a sweep takes the colours one after another, the chunks of a colour in parallel,
// the rows of a chunk in order, and every row sees exactly the new values of the rows before it and the old ones of
// those after it.
#pragma once

#include "solver/surface_matrix.h"

namespace stormfield {

struct SweepOrder {
  std::vector<Index> order;        ///< row i of the new numbering is row order[i] of the old
  std::vector<Index> chunkStart;   ///< chunks + 1, in new rows
  std::vector<Index> pairEnd;      ///< per chunk: rows from its start up to here are pairs, the others single
  std::vector<Index> colourStart;  ///< colours + 1, in chunks

  Index chunks() const { return static_cast<Index>(chunkStart.size()) - 1; }
  Index colours() const { return static_cast<Index>(colourStart.size()) - 1; }
};

SweepOrder sweepOrder(const SurfaceMatrix& matrix, Index rowsPerChunk);

}  // namespace stormfield
