#include "short_tour.hpp"

#include <algorithm>
#include <numeric>

namespace topogeo::navigation {
namespace {

constexpr double kShorter_m = 1e-6;

std::vector<std::size_t> nearest_first(const WayTable& ways_m) {
  std::vector<std::size_t> order(ways_m.places());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (auto next = order.begin(); next != order.end(); ++next) {
    const auto way_m = [&](std::size_t place) {
      return next == order.begin() ? ways_m.from_start(place) : ways_m.between(*(next - 1), place);
    };
    std::iter_swap(next, std::min_element(next, order.end(), [&](std::size_t a, std::size_t b) {
                     return way_m(a) < way_m(b);
                   }));
  }
  return order;
}

/// Takes over `other` if it is shorter.
bool improve(const WayTable& ways_m, std::vector<std::size_t>& order,
             const std::vector<std::size_t>& other) {
  if (length_m(ways_m, other) >= length_m(ways_m, order) - kShorter_m) return false;
  order = other;
  return true;
}

/// One round of all changes; whether one helped.
bool improve_once(const WayTable& ways_m, std::vector<std::size_t>& order) {
  const auto places = static_cast<std::ptrdiff_t>(order.size());
  bool better = false;
  for (std::ptrdiff_t a = 0; a < places; ++a) {
    for (std::ptrdiff_t b = a + 1; b < places; ++b) {
      std::vector<std::size_t> turned = order;
      std::reverse(turned.begin() + a, turned.begin() + b + 1);
      better = improve(ways_m, order, turned) || better;
      std::vector<std::size_t> later = order;
      std::rotate(later.begin() + a, later.begin() + a + 1, later.begin() + b + 1);
      better = improve(ways_m, order, later) || better;
      std::vector<std::size_t> earlier = order;
      std::rotate(earlier.begin() + a, earlier.begin() + b, earlier.begin() + b + 1);
      better = improve(ways_m, order, earlier) || better;
    }
  }
  return better;
}

}  // namespace

double length_m(const WayTable& ways_m, const std::vector<std::size_t>& order) {
  if (order.empty()) return 0.0;
  double sum_m = ways_m.from_start(order.front());
  for (std::size_t i = 1; i < order.size(); ++i) sum_m += ways_m.between(order[i - 1], order[i]);
  return sum_m;
}

std::vector<std::size_t> short_tour(const WayTable& ways_m) {
  std::vector<std::size_t> order = nearest_first(ways_m);
  while (improve_once(ways_m, order)) {
  }
  return order;
}

}  // namespace topogeo::navigation
