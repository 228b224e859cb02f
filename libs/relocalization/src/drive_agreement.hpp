// Joint evidence of the matches of a drive with a map: several stops whose poses in the map agree
// with each other prove a place that none of them proves alone.
#pragma once

#include <deque>

namespace topogeo::localization {

class DriveAgreement {
 public:
  /// The drive continued.
  void move(double distance_m) { path_m_ += distance_m; }
  /// A stop was matched at its expected place, by a match that passed its gate, or by one that is
  /// right with this probability.
  void add(bool accepted, double confidence);
  /// A stop was matched elsewhere, or a match was expected and failed.
  void contradict();

  /// Whether enough of the last stops agree, far enough apart, to be right together.
  [[nodiscard]] bool enough() const;
  /// Sum over the last metres: 1.5 for each stop with an accepted match, up to 1 for any other.
  [[nodiscard]] double weight() const;

 private:
  struct Agreed {
    double path_m;
    double weight;
  };
  std::deque<Agreed> agreed_;
  double path_m_ = 0.0;
};

}  // namespace topogeo::localization
