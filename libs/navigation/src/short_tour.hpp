// The order of visits to a few places.
#pragma once

#include <cstddef>
#include <vector>

namespace topogeo::navigation {

/// Distances between a start and some places and among these, symmetric, metres.
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

/// Length of a tour from the start past the places in this order, ending at the last.
double length_m(const DistanceTable& distances_m, const std::vector<std::size_t>& order);

/// A short tour past all places: nearest neighbour first, then reversals of pieces and moves of
/// single places as long as they shorten it. Not always the shortest.
std::vector<std::size_t> short_tour(const DistanceTable& distances_m);

}  // namespace topogeo::navigation
