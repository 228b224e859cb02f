#include "run/ground_truth_log.hpp"

#include <utility>

#include "topogeo/service/conversions.hpp"

namespace topogeo::cli {

GroundTruthLog::GroundTruthLog(const messaging::Participant& participant,
                               messaging::EventLoop& loop, std::string robot_id, Handler on_truth)
    : robot_id_(std::move(robot_id)), on_truth_(std::move(on_truth)), truths_(participant) {
  loop.add<msg::GroundTruth>(truths_,
                             [this](const msg::GroundTruth& truth, const messaging::SampleInfo&) {
                               if (truth.robot_id() == robot_id_.c_str()) add(truth);
                             });
}

void GroundTruthLog::add(const msg::GroundTruth& truth) {
  const double step_s = poses_.empty() ? 0.0 : truth.time_s() - last_.time_s();
  poses_.push_back({poses_.size(), truth.stamp_ns(), service::from_msg(truth.T_world_robot())});
  last_ = truth;
  if (on_truth_) on_truth_(truth, step_s);
}

}  // namespace topogeo::cli
