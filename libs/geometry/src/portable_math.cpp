#include "topogeo/geometry/portable_math.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace topogeo::geometry {
namespace {

// pi/2 and ln 2, each split into a part with trailing zeros, whose small multiples are exact, and a
// remainder.
constexpr double kHalfPiHigh = 0x1.921fb544p+0;
constexpr double kHalfPiLow = 0x1.0b4611a626331p-34;
constexpr double kLn2High = 0x1.62e42feep-1;
constexpr double kLn2Low = 0x1.a39ef35793c76p-33;

// Sum of c[i] x^i by Horner's rule.
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

constexpr std::array<double, 8> kSine = {1.0,
                                         -1.0 / 6.0,
                                         1.0 / 120.0,
                                         -1.0 / 5040.0,
                                         1.0 / 362880.0,
                                         -1.0 / 39916800.0,
                                         1.0 / 6227020800.0,
                                         -1.0 / 1307674368000.0};
constexpr std::array<double, 9> kCosine = {1.0,
                                           -1.0 / 2.0,
                                           1.0 / 24.0,
                                           -1.0 / 720.0,
                                           1.0 / 40320.0,
                                           -1.0 / 3628800.0,
                                           1.0 / 479001600.0,
                                           -1.0 / 87178291200.0,
                                           1.0 / 20922789888000.0};

// The reduction below overflows its numbers beyond this angle; no robot turns so often.
constexpr double kManyTurns_rad = 1e9;

// Arc tangent of t in [0, 1]: two halvings of the angle bring t below 0.2, where the series is
// short.
double atan_unit(double t) {
  double scale = 1.0;
  for (int k = 0; k < 2; ++k) {
    t = t / (1.0 + std::sqrt(1.0 + t * t));
    scale *= 2.0;
  }
  const double u = t * t;
  double sum = 0.0;
  for (int n = 25; n >= 3; n -= 2) sum = (1.0 / n - sum) * u;
  return scale * (t - t * sum);
}

}  // namespace

SinCos sincos(double angle_rad) {
  if (!(std::fabs(angle_rad) < kManyTurns_rad)) {
    if (!std::isfinite(angle_rad)) return {std::nan(""), std::nan("")};
    angle_rad = std::remainder(angle_rad, 2.0 * std::numbers::pi);  // exact, so the same everywhere
  }
  const double quarter = std::nearbyint(angle_rad * (2.0 / std::numbers::pi));
  const double r = (angle_rad - quarter * kHalfPiHigh) - quarter * kHalfPiLow;
  const double u = r * r;
  const double s = r * polynomial(kSine, u);
  const double c = polynomial(kCosine, u);
  switch (static_cast<std::int64_t>(quarter) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double atan2(double y, double x) {
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double angle = ay <= ax ? atan_unit(ay / ax) : std::numbers::pi / 2.0 - atan_unit(ax / ay);
  if (x < 0.0) angle = std::numbers::pi - angle;
  return y < 0.0 ? -angle : angle;
}

double exp(double x) {
  if (x < -700.0) return 0.0;
  if (x > 700.0) x = 700.0;
  const double k = std::nearbyint(x * (1.0 / std::numbers::ln2));
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1.0;
  for (int n = 14; n >= 1; --n) sum = 1.0 + sum * r / n;
  const auto exponent = static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023);
  return sum * std::bit_cast<double>(exponent << 52U);
}

double log(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<std::int64_t>(bits >> 52U) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffULL) | (1023ULL << 52U));
  if (m > std::numbers::sqrt2) {
    m *= 0.5;
    ++exponent;
  }
  // log m = 2 atanh(s), |s| < 0.172
  const double s = (m - 1.0) / (m + 1.0);
  const double u = s * s;
  double sum = 0.0;
  for (int n = 23; n >= 3; n -= 2) sum = (1.0 / n + sum) * u;
  const double k = static_cast<double>(exponent);
  return k * kLn2High + (k * kLn2Low + 2.0 * (s + s * sum));
}

}  // namespace topogeo::geometry
