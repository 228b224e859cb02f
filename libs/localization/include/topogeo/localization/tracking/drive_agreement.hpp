// What the matches of a drive with a map are worth together: several stops of it that lie in the
// map as they lie to each other prove a place that none of them proves alone.
#pragma once

#include <deque>

namespace topogeo::localization {

class DriveAgreement {
 public:
  /// The drive went on.
  void move(double distance_m) { path_m_ += distance_m; }
  /// A stop was matched where the stops before have it, by a match that passed its gate, or by one
  /// that is right with this probability.
  void add(bool accepted, double confidence);
  /// A stop was matched elsewhere, or should have been matched and was not.
  void contradict();

  /// Whether so many of the last stops agree, so far apart, that together they are right.
  [[nodiscard]] bool enough() const;
  /// 1.5 for each stop by an accepted match, up to 1 for each other one, over the last metres.
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
