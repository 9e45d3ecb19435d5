// Speed that does not fade far from the design elements.
//
// A harmonic field (thesis eq. 11.3) fades away from what constrains it, and texture would stand still there. Every
// vector is multiplied by s^amount, s = U / sqrt(|V|^2 + reach^2 G), with G = |grad V|^2 / 2 from the connection
// differences around the vertex, averaged over its neighbours, and U the mean speed of the field where it is fast (the
// mean of |V|^2 over that of |V|, over surface and lambda). At a distance r from a fixed point |V| is about sqrt(G) r,
// so that with amount 1 the speed is U r / sqrt(r^2 + reach^2): zero at the fixed point, U away from it, at any
// resolution. The factors are positive: directions, fixed points and Poincare indices stay.
#pragma once

#include "field/parameterized_field.h"

namespace stormfield {

/// amount: 0 (the field as it is) to 1; reach: mesh units, above zero. Throws InputError outside of these.
ParameterizedField evenSpeed(const ParameterizedField& field, double amount, double reach);

}  // namespace stormfield
