#include "edit/contents.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/message.h"

namespace stormfield {

void Contents::add(FixedPointKind kind) {
  switch (kind) {
    case FixedPointKind::Source:
      ++sources;
      return;
    case FixedPointKind::Sink:
      ++sinks;
      return;
    case FixedPointKind::Saddle:
      ++saddles;
      return;
    default:
      ++other;
  }
}

void Contents::add(OrbitKind kind) {
  switch (kind) {
    case OrbitKind::Attracting:
      ++attractingOrbits;
      return;
    case OrbitKind::Repelling:
      ++repellingOrbits;
      return;
    default:
      ++other;
  }
}

Contents fewestContents(const ConleyIndex& index) {
  Contents contents;
  contents.attractingOrbits = std::min(index.b0, index.b1);
  contents.repellingOrbits = std::min(index.b2, index.b1 - contents.attractingOrbits);
  contents.sinks = index.b0 - contents.attractingOrbits;
  contents.sources = index.b2 - contents.repellingOrbits;
  contents.saddles = index.b1 - contents.attractingOrbits - contents.repellingOrbits;
  return contents;
}

std::string describe(const Contents& contents) {
  std::vector<std::string> parts;
  const auto add = [&](int count, const char* one, const char* several) {
    if (count == 1) parts.push_back(message("one ", one));
    if (count > 1) parts.push_back(message(count, " ", several));
  };
  add(contents.sources, "source", "sources");
  add(contents.sinks, "sink", "sinks");
  add(contents.attractingOrbits, "attracting orbit", "attracting orbits");
  add(contents.repellingOrbits, "repelling orbit", "repelling orbits");
  add(contents.saddles, "saddle", "saddles");
  add(contents.other, "center or degenerate entity", "centers or degenerate entities");
  if (parts.empty()) return "nothing";
  std::string text = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) text += (i + 1 < parts.size() ? ", " : " and ") + parts[i];
  return text;
}

}  // namespace stormfield
