// Prints how many microseconds a fixed amount of work takes on this machine: the best of several
// runs, because other programs can only add time. cmake/TopogeoTimeFactor.cmake compares it with
// the reference machine.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

// Floating-point work with branches, and memory accesses beyond the first cache.
double work(std::vector<std::uint32_t>& next) {
  double sum = 0.0;
  std::uint32_t place = 1;
  for (int i = 0; i < 100'000; ++i) {
    place = next[place];
    const double x = 1e-4 * static_cast<double>(place);
    sum += place % 3 == 0 ? std::sqrt(x + sum * 1e-9) : std::sin(x);
  }
  return sum;
}

}  // namespace

int main() {
  constexpr std::uint32_t kPlaces = 1U << 16U;
  constexpr int kRuns = 80;
  std::vector<std::uint32_t> next(kPlaces);
  for (std::uint32_t i = 0; i < kPlaces; ++i) next[i] = (i * 1664525U + 1013904223U) % kPlaces;

  using std::chrono::steady_clock;
  double sum = 0.0;
  auto best = steady_clock::duration::max();
  for (int run = 0; run < kRuns; ++run) {
    const auto start = steady_clock::now();
    sum += work(next);
    const auto passed = steady_clock::now() - start;
    if (passed < best) best = passed;
  }
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(best).count();
  std::printf("%lld\n", static_cast<long long>(us));
  return std::isfinite(sum) ? 0 : 1;  // An unused result would let the compiler drop the work.
}
