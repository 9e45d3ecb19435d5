#include "morse/refinement_stop.h"

namespace stormfield {

const char* name(RefinementStop stop) {
  switch (stop) {
    case RefinementStop::Steps:
      return "steps";
    case RefinementStop::Time:
      return "time";
    case RefinementStop::Memory:
      return "memory";
    case RefinementStop::Cancelled:
      return "cancelled";
    case RefinementStop::Done:
      break;
  }
  return "done";
}

}  // namespace stormfield
