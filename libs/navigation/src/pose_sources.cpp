#include "pose_sources.hpp"

namespace topogeo::navigation {

PoseSources::PoseSources(const NavigatorConfig& config)
    : largest_sigma_m_(config.largest_sigma_m),
      keeper_({config.oldest_pose_s, config.oldest_odometry_s, config.largest_sigma_m}),
      markov_(config) {}

void PoseSources::add(const PoseFix& pose) {
  if (markov_.on()) {
    markov_.add(pose);
  } else {
    keeper_.add(pose);
  }
}

void PoseSources::add(const OdometrySample& odometry) {
  keeper_.add(odometry);
  markov_.add(odometry);
}

std::optional<double> PoseSources::update(bool primitive_finished, std::int64_t now_ns) {
  if (!markov_.on()) return std::nullopt;
  if (primitive_finished) markov_.primitive_done();
  markov_pose_ = markov_.pose();
  if (const auto& fix = markov_pose_) {
    keeper_.add(*fix);
    // Looks while the pose is still good enough to drive, before it counts as lost.
    constexpr double kUnsure = 0.8;  // of the largest deviation
    const bool unsure = keeper_.sigma_m() > kUnsure * largest_sigma_m_;
    if ((unsure || !fix->tracking) && !markov_.looks()) markov_.begin_look(now_ns);
  }
  const auto corrected_m = markov_.look(now_ns);
  if (!corrected_m) return std::nullopt;
  markov_pose_ = markov_.pose();
  if (markov_pose_) keeper_.add(*markov_pose_);
  return corrected_m;
}

void PoseSources::set_path(std::span<const planning::PathSample> path,
                           std::span<const Eigen::Vector2d> nodes_m) {
  markov_.set_path(path, nodes_m);
}

bool PoseSources::must_stand(bool at_end, std::optional<double> progress_m, std::int64_t now_ns) {
  if (!markov_.on()) return false;
  if (at_end && !markov_.looks()) markov_.begin_look(now_ns);
  if (progress_m && markov_.comes_to_node(*progress_m)) markov_.begin_look(now_ns);
  return markov_.looks();
}

}  // namespace topogeo::navigation
