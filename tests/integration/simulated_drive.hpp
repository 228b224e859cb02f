// A drive of `topogeo run --sim` that lasts until the test ends it, so that events happen in the
// middle of it on a machine of any speed.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/status.h"

#include "join.hpp"
#include "program.hpp"

namespace topogeo::test {

/// Writes the hall of the short drive with a tour of a hundred rounds, 11 m each.
inline std::string write_world_of_rounds(const Scratch& scratch) {
  constexpr int kRounds = 100;
  std::string text = read_file(std::string(TOPOGEO_SHARE) + "/worlds/short.world.yaml");
  text.resize(text.rfind("tour:"));
  text += "tour: [";
  for (int round = 0; round < kRounds; ++round) {
    text += "[1.2, 2.2], [6.2, 2.2], [6.2, 2.9], [1.2, 2.9], ";
  }
  text += "[1.2, 2.2]]\n";
  const std::filesystem::path file = scratch / "rounds.world.yaml";
  std::ofstream(file) << text;
  return file.string();
}

/// Follows the simulated robot of the test's domain.
class DriveWatch {
 public:
  /// Waits until the robot has driven so much further from now on. False when `run` has ended
  /// before.
  [[nodiscard]] bool wait_for_distance(Program& run, double further_m) {
    receive();
    const double end_m = driven_m_ + further_m;
    return wait_while_it_runs("the robot to drive on", run, [&] { return driven_m_ >= end_m; });
  }
  /// Waits until the localizer has taken so many local maps. False when `run` has ended before.
  [[nodiscard]] bool wait_for_local_maps(Program& run, double count) {
    return wait_while_it_runs("local maps", run, [&] { return local_maps_ >= count; });
  }

 private:
  template <class Condition>
  bool wait_while_it_runs(const std::string& what, Program& run, const Condition& condition) {
    const bool there = wait_for(what, [&] {
      receive();
      return condition() || run.ended();
    });
    return there && condition();
  }

  void receive() {
    truths_.take([this](const msg::GroundTruth& truth, const messaging::SampleInfo& info) {
      if (!info.valid) return;
      const Eigen::Vector2d at_m(truth.T_world_robot().x_m(), truth.T_world_robot().y_m());
      if (at_m_) driven_m_ += (at_m - *at_m_).norm();
      at_m_ = at_m;
    });
    statuses_.take([this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.service() != "localizer") return;
      for (const msg::Counter& counter : status.counters()) {
        if (counter.name() == "local_maps") local_maps_ = counter.value();
      }
    });
  }

  messaging::Participant participant_ = join(own_domain(), messaging::kAnyPartition);
  messaging::Reader<msg::GroundTruth> truths_{participant_};
  messaging::Reader<msg::ServiceStatus> statuses_{participant_};
  std::optional<Eigen::Vector2d> at_m_;
  double driven_m_ = 0.0;
  double local_maps_ = 0.0;
};

}  // namespace topogeo::test
