// The order in which to visit a few places.
#pragma once

#include <cstddef>
#include <vector>

namespace topogeo::navigation {

/// Distances from a start to each of some places and between them, the same in both directions,
/// metres.
class DistanceTable {
 public:
  explicit DistanceTable(std::size_t places)
      : places_(places), start_(places), between_(places * places) {}

  [[nodiscard]] std::size_t places() const { return places_; }
  [[nodiscard]] double& from_start(std::size_t place) { return start_[place]; }
  [[nodiscard]] double from_start(std::size_t place) const { return start_[place]; }
  [[nodiscard]] double& between(std::size_t a, std::size_t b) { return between_[at(a, b)]; }
  [[nodiscard]] double between(std::size_t a, std::size_t b) const { return between_[at(a, b)]; }

 private:
  [[nodiscard]] std::size_t at(std::size_t a, std::size_t b) const {
    return a < b ? a * places_ + b : b * places_ + a;
  }
  std::size_t places_;
  std::vector<double> start_;
  std::vector<double> between_;
};

/// Length of a tour from the start past the places in this order, which ends at the last.
double length_m(const DistanceTable& distances_m, const std::vector<std::size_t>& order);

/// A short tour past all places, by going on to the nearest and then turning pieces of it round and
/// moving places within it as long as that makes it shorter. Not always the shortest.
std::vector<std::size_t> short_tour(const DistanceTable& distances_m);

}  // namespace topogeo::navigation
