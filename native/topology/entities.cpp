#include "topology/entities.h"

namespace stormfield {

const char* name(FixedPointKind kind) {
  switch (kind) {
    case FixedPointKind::Source:
      return "source";
    case FixedPointKind::Sink:
      return "sink";
    case FixedPointKind::Saddle:
      return "saddle";
    case FixedPointKind::Center:
      return "center";
    case FixedPointKind::Degenerate:
      break;
  }
  return "degenerate";
}

const char* name(OrbitKind kind) {
  switch (kind) {
    case OrbitKind::Attracting:
      return "attracting";
    case OrbitKind::Repelling:
      return "repelling";
    case OrbitKind::Center:
      return "center";
    case OrbitKind::Degenerate:
      break;
  }
  return "degenerate";
}

}  // namespace stormfield
