#include "short_tour.hpp"

#include <algorithm>
#include <numeric>

namespace topogeo::navigation {
namespace {

constexpr double kShorter_m = 1e-6;  // less is rounding, and might never end

std::vector<std::size_t> nearest_first(const DistanceTable& distances_m) {
  std::vector<std::size_t> order(distances_m.places());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (auto next = order.begin(); next != order.end(); ++next) {
    const auto distance_m = [&](std::size_t place) {
      return next == order.begin() ? distances_m.from_start(place)
                                   : distances_m.between(*(next - 1), place);
    };
    std::iter_swap(next, std::min_element(next, order.end(), [&](std::size_t a, std::size_t b) {
                     return distance_m(a) < distance_m(b);
                   }));
  }
  return order;
}

/// Takes `other` if it is shorter.
bool improve(const DistanceTable& distances_m, std::vector<std::size_t>& order,
             const std::vector<std::size_t>& other) {
  if (length_m(distances_m, other) >= length_m(distances_m, order) - kShorter_m) return false;
  order = other;
  return true;
}

/// Tries all changes once; returns whether one helped.
bool improve_once(const DistanceTable& distances_m, std::vector<std::size_t>& order) {
  const auto places = static_cast<std::ptrdiff_t>(order.size());
  bool better = false;
  for (std::ptrdiff_t a = 0; a < places; ++a) {
    for (std::ptrdiff_t b = a + 1; b < places; ++b) {
      std::vector<std::size_t> turned = order;
      std::reverse(turned.begin() + a, turned.begin() + b + 1);
      better = improve(distances_m, order, turned) || better;
      std::vector<std::size_t> later = order;
      std::rotate(later.begin() + a, later.begin() + a + 1, later.begin() + b + 1);
      better = improve(distances_m, order, later) || better;
      std::vector<std::size_t> earlier = order;
      std::rotate(earlier.begin() + a, earlier.begin() + b, earlier.begin() + b + 1);
      better = improve(distances_m, order, earlier) || better;
    }
  }
  return better;
}

}  // namespace

double length_m(const DistanceTable& distances_m, const std::vector<std::size_t>& order) {
  if (order.empty()) return 0.0;
  double sum_m = distances_m.from_start(order.front());
  for (std::size_t i = 1; i < order.size(); ++i)
    sum_m += distances_m.between(order[i - 1], order[i]);
  return sum_m;
}

std::vector<std::size_t> short_tour(const DistanceTable& distances_m) {
  std::vector<std::size_t> order = nearest_first(distances_m);
  while (improve_once(distances_m, order)) {
  }
  return order;
}

}  // namespace topogeo::navigation
