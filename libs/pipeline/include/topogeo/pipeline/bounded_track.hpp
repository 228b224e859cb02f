// The scans since the last stop: all of them, or evenly spaced ones if a robot stands for so long
// that they would be too many. The last one is always included.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::pipeline {

class BoundedTrack {
 public:
  /// Limit of scans, at least 2.
  explicit BoundedTrack(std::size_t most) : most_(most) {}

  void add(const topomap::TrackedScan& scan) {
    const bool last_is_spare = !scans_.empty() && (added_ - 1) % step_ != 0;
    if (last_is_spare) scans_.pop_back();
    scans_.push_back(scan);
    ++added_;
    if (scans_.size() > most_) thin_out();
  }

  [[nodiscard]] bool empty() const { return scans_.empty(); }
  [[nodiscard]] const topomap::TrackedScan& last() const { return scans_.back(); }
  void drop_last() {
    scans_.pop_back();
    --added_;
  }

  /// Returns all kept scans and clears the track.
  std::vector<topomap::TrackedScan> take() {
    added_ = 0;
    step_ = 1;
    return std::exchange(scans_, {});
  }

 private:
  // Keeps the scans 0, `step_`, 2 * `step_` and so on, and the last one.
  void thin_out() {
    const topomap::TrackedScan last = scans_.back();
    scans_.pop_back();
    for (std::size_t i = 1; 2 * i < scans_.size(); ++i) scans_[i] = scans_[2 * i];
    scans_.resize((scans_.size() + 1) / 2);
    scans_.push_back(last);
    step_ *= 2;
  }

  std::size_t most_;
  std::vector<topomap::TrackedScan> scans_;
  std::size_t added_ = 0;
  std::size_t step_ = 1;  // between two kept scans
};

}  // namespace topogeo::pipeline
