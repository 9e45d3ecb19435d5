// That an edit changed what it says and nothing else, or nothing at all.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "edit/edited_fields.h"

namespace stormfield::test {

/// What holds after every try: nothing but the block's vectors changed, and a refusal has a reason and changes nothing.
inline void expectWhole(const VectorField& field, const Topology& before, const EntityRef& a, const EntityRef& b,
                        const EditResult& result) {
  std::vector<Index> changed;
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (field.values[v] != result.field.values[v]) changed.push_back(static_cast<Index>(v));
  }
  if (!result.applied) {
    EXPECT_TRUE(changed.empty());
    EXPECT_FALSE(result.reason.empty());
    return;
  }
  EXPECT_FALSE(changed.empty());
  EXPECT_TRUE(std::includes(result.vertices.begin(), result.vertices.end(), changed.begin(), changed.end()));
  for (const Index v : result.vertices) {
    for (Index h = field.mesh().outgoing(v); h != kNone; h = field.mesh().nextOutgoing(h)) {
      EXPECT_TRUE(std::binary_search(result.faces.begin(), result.faces.end(), TriangleMesh::face(h)));
    }
  }
  // Found again, apart from what the edit itself saw.
  const Topology after = topologyOf(result.field);
  const Interval interval = findInterval(before, field.mesh(), a, b);
  EXPECT_EQ(indexSum(after), indexSum(before));
  EXPECT_EQ(contentsOf(after, result.left), fewestContents(result.index));
  const std::size_t gone = 2 + interval.saddles.size();
  EXPECT_EQ(after.fixedPoints.size() + after.periodicOrbits.size() + gone,
            before.fixedPoints.size() + before.periodicOrbits.size() + result.left.size());
  // Every fixed point outside is there with the same bits, and a saddle there keeps the ends of its separatrices.
  std::map<Index, Index> numbers;
  for (std::size_t i = 0; i < before.fixedPoints.size(); ++i) {
    if (interval.holds({EntityKind::FixedPoint, static_cast<Index>(i)})) continue;
    const FixedPoint& p = before.fixedPoints[i];
    const auto found = std::find_if(after.fixedPoints.begin(), after.fixedPoints.end(), [&](const FixedPoint& q) {
      return p.kind == q.kind && p.point.face == q.point.face && p.point.barycentric == q.point.barycentric;
    });
    ASSERT_NE(found, after.fixedPoints.end());
    numbers[static_cast<Index>(i)] = static_cast<Index>(found - after.fixedPoints.begin());
  }
  std::multiset<std::tuple<Index, bool, Index>> endsBefore, endsAfter;
  for (const Separatrix& s : before.separatrices) {
    if (!numbers.contains(s.saddle) || s.end.kind != EntityKind::FixedPoint || interval.holds(s.end)) continue;
    endsBefore.insert({numbers[s.saddle], s.outgoing, numbers[s.end.index]});
  }
  for (const Separatrix& s : after.separatrices) {
    if (s.end.kind == EntityKind::FixedPoint) endsAfter.insert({s.saddle, s.outgoing, s.end.index});
  }
  EXPECT_TRUE(std::includes(endsAfter.begin(), endsAfter.end(), endsBefore.begin(), endsBefore.end()));
}

}  // namespace stormfield::test
