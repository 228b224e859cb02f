// Transcendental functions that give the same bits on every machine.
//
// libm selects variants by CPU, so two workers could answer one match task differently. These
// functions use only IEEE additions, multiplications, divisions and square roots in a fixed order
// (compile with -ffp-contract=off). Accuracy: within 4 ulp of libm over the ranges named below
// (compared by unit tests). The trade-off is speed: about twice the time of libm, which no profile
// of the matcher shows.
#pragma once

namespace topogeo::geometry {

struct SinCos {
  double sin;
  double cos;
};

/// Sine and cosine of an angle in radians, |angle_rad| <= 1e5.
SinCos sincos(double angle_rad);

/// Angle of the vector (x, y) in (-pi, pi]; 0 for the zero vector.
double atan2(double y, double x);

/// e^x for x in [-700, 700]; 0 below that range, the value at 700 above it.
double exp(double x);

/// Natural logarithm of a positive normal number.
double log(double x);

}  // namespace topogeo::geometry
