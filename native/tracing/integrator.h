// The one integrator behind streamlines and pathlines: dx/dt = V(x; t) on the surface, face by face in flat frames.
//
// A steady flow takes most faces in one step (tracing/face_path.h), which may also be computed for several particles
// side by side (tracing/side_by_side.h). Elsewhere Merson's fourth-order Runge-Kutta rule
// (Merson 1957) estimates and controls the error; a step is tried a little farther than the straight exit from the
// face, and where the cubic through its ends crosses an edge, it ends on that edge, at the same point for both faces.
// Because the field is continuous across edges, following an edge or touching it needs no special case beyond a slack
// of round-off size. A trace that meets a vertex leaves it in the direction that the vertex's own vector has in its
// chart, which is the one direction that is right for any sum of corner angles. Nothing is allocated.
#pragma once

#include "tracing/detail/integrator_steps.h"
#include "tracing/detail/integrator_vertices.h"
