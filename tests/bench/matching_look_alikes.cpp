#include "matching_look_alikes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/support/seed.hpp"

namespace topogeo::bench {

using geometry::Pose2;
using localization::MatchResult;
using localization::MatchTask;
using localization::Reason;
using localization::UncertainPose;
using localization::Verdict;
using support::Random;

namespace {

constexpr double kWrong_m = 0.3;
constexpr double kWrong_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double kHalfWidths_m[] = {0.5, 1.0, 1.5, 3.0};

/// A prediction whose search space has the half-widths w, w and half a radian per metre up to 1.
UncertainPose prediction(const Pose2& T_expected, double half_width_m) {
  const localization::LocalizerConfig config;
  const double sigma_m =
      half_width_m / std::sqrt(localization::ellipse_k2(config.search_probability));
  const double sigma_rad = std::min(1.0, 0.5 * half_width_m) / config.search_heading_sigmas;
  UncertainPose pose;
  pose.T_a_b = T_expected;
  pose.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  return pose;
}

/// Moves a prediction away from its pose, by its own covariance, but not so far that its search
/// space no longer holds that pose.
void disturb(UncertainPose& pose, double share, Random& random) {
  const auto draw = [&](double sigma, double most) {
    double value = 0.0;
    do {
      value = share * sigma * random.normal();
    } while (std::fabs(value) > most);
    return value;
  };
  const localization::LocalizerConfig config;
  const Eigen::Vector3d half = localization::search_half_width(
      pose.covariance, config.search_probability, config.search_heading_sigmas);
  pose.T_a_b.x_m += draw(std::sqrt(pose.covariance(0, 0)), half.x());
  pose.T_a_b.y_m += draw(std::sqrt(pose.covariance(1, 1)), half.y());
  pose.T_a_b.theta_rad =
      geometry::wrap_angle(pose.T_a_b.theta_rad + draw(std::sqrt(pose.covariance(2, 2)), half.z()));
}

}  // namespace

LookAlikes::Counts& LookAlikes::Counts::operator+=(const Counts& other) {
  pairs += other.pairs;
  right += other.right;
  wrong += other.wrong;
  for (std::size_t i = 0; i < reasons.size(); ++i) reasons[i] += other.reasons[i];
  return *this;
}

const char* LookAlikes::name_of(Kind kind) {
  switch (kind) {
    case Kind::kOverlapping:
      return "overlapping";
    case Kind::kCorridor:
      return "corridor, 1-3 m off";
    case Kind::kApart:
      return "apart, random";
    case Kind::kLookAlike:
      return "apart, most alike";
  }
  return "unknown";
}

LookAlikes::LookAlikes(std::size_t pairs, const std::string& samples_file) : pairs_(pairs) {
  if (samples_file.empty()) return;
  samples_.open(samples_file);
  if (!samples_) throw std::runtime_error(samples_file + ": cannot be written");
  samples_
      << "log,kind,half_width_m,reference,query,right,reason,error_m,error_deg,overlap,inliers,"
         "violations,residual_m,scan_fitness,topological_fitness,fitness,second,second_m,"
         "doubt,weak_sigma_m,sigma_rad,mahalanobis2,points,other_points,predicted_x_m,predicted_y_"
         "m,"
         "predicted_theta_rad,x_m,y_m,theta_rad\n";
}

void LookAlikes::add(MatchingRun& run) {
  Random random(support::derive_seed(1, run.name(), {pairs_}));
  logs_.push_back(run.name());
  try_pairs(run, Kind::kOverlapping, overlapping_pairs(run, pairs_, random), random);
  try_pairs(run, Kind::kCorridor, corridor_pairs(run, pairs_, random), random);
  try_pairs(run, Kind::kApart, apart_pairs(run, pairs_, random), random);
  try_pairs(run, Kind::kLookAlike, look_alike_pairs(run, pairs_), random);
}

void LookAlikes::try_pairs(MatchingRun& run, Kind kind, const std::vector<StopPair>& pairs,
                           Random& random) {
  for (const StopPair& pair : pairs) {
    for (const double half_width_m : kHalfWidths_m) {
      if (kind == Kind::kCorridor && half_width_m < 1.5) continue;  // would not hold the truth
      try_pair(run, kind, pair, half_width_m, random);
    }
  }
}

void LookAlikes::try_pair(MatchingRun& run, Kind kind, const StopPair& pair, double half_width_m,
                          Random& random) {
  UncertainPose expected = prediction(pair.T_reference_looked, half_width_m);
  disturb(expected, kind == Kind::kCorridor ? 0.3 : 1.0, random);
  if (kind == Kind::kCorridor) {
    const double along_m =
        random.uniform(1.0, half_width_m) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    expected.T_a_b = pair.T_reference_looked;
    expected.T_a_b.x_m += along_m * pair.along.x();
    expected.T_a_b.y_m += along_m * pair.along.y();
  }
  const MatchTask task = run.task(pair.reference, pair.query, expected);
  const MatchResult result = run.matcher().solve(task);
  const PoseError error = error_of(result.T_reference_query, pair.T_reference_query);
  const bool overlapping = kind == Kind::kOverlapping || kind == Kind::kCorridor;
  const bool right = overlapping && error.m <= kWrong_m && error.rad <= kWrong_rad;
  Counts& counts = counts_[{logs_.size() - 1, kind, half_width_m}];
  ++counts.pairs;
  ++counts.reasons[static_cast<std::size_t>(result.reason)];
  if (result.verdict == Verdict::kAccepted) ++(right ? counts.right : counts.wrong);
  if (samples_.is_open()) write_sample(run, kind, pair, half_width_m, task, result, right);
}

void LookAlikes::write_sample(const MatchingRun& run, Kind kind, const StopPair& pair,
                              double half_width_m, const MatchTask& task, const MatchResult& result,
                              bool right) {
  const PoseError error = error_of(result.T_reference_query, pair.T_reference_query);
  const Eigen::Matrix2d position = result.covariance.topLeftCorner<2, 2>();
  const double weak_sigma_m =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues()[1]);
  const Eigen::Vector3d off =
      geometry::difference(result.T_reference_query, task.T_reference_query);
  const double second_m =
      (result.second.T_reference_query.position_m() - result.T_reference_query.position_m()).norm();
  samples_ << run.name() << ',' << static_cast<int>(kind) << ',' << half_width_m << ','
           << pair.reference << ',' << pair.query << ',' << right << ','
           << static_cast<int>(result.reason) << ',' << error.m << ','
           << error.rad * 180.0 / std::numbers::pi << ',' << result.overlap << ',' << result.inliers
           << ',' << result.violations << ',' << result.residual_rms_m << ',' << result.scan_fitness
           << ',' << result.topological_fitness << ',' << result.fitness << ','
           << result.second.fitness << ',' << second_m << ',' << localization::doubt(result) << ','
           << weak_sigma_m << ',' << std::sqrt(result.covariance(2, 2)) << ','
           << off.dot(task.covariance.inverse() * off) << ','
           << run.features(pair.query).surface.size() << ','
           << run.features(pair.reference).surface.size() << ',' << task.T_reference_query.x_m
           << ',' << task.T_reference_query.y_m << ',' << task.T_reference_query.theta_rad << ','
           << result.T_reference_query.x_m << ',' << result.T_reference_query.y_m << ','
           << result.T_reference_query.theta_rad << '\n';
}

void LookAlikes::print(std::FILE* out) const {
  std::fputs(
      "| log | pairs | half-width m | number | right, accepted | wrong, accepted | share wrong | "
      "ambiguous | nothing in common | little overlap | few inliers | doubtful | far from the "
      "prediction |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      out);
  const auto row = [&](const std::string& log, const std::string& kind, const std::string& width,
                       const Counts& c) {
    const auto reason = [&](Reason r) { return c.reasons[static_cast<std::size_t>(r)]; };
    const double per_pair = 1.0 / static_cast<double>(std::max<std::size_t>(1, c.pairs));
    std::fprintf(
        out, "| %s | %s | %s | %zu | %.3f | %zu | %.4f | %zu | %zu | %zu | %zu | %zu | %zu |\n",
        log.c_str(), kind.c_str(), width.c_str(), c.pairs, per_pair * static_cast<double>(c.right),
        c.wrong, per_pair * static_cast<double>(c.wrong), reason(Reason::kSecondSolution),
        reason(Reason::kNothingInCommon), reason(Reason::kLittleOverlap),
        reason(Reason::kFewInliers), reason(Reason::kDoubtful), reason(Reason::kImplausible));
  };
  const auto text = [](double width_m) {
    char digits[16];
    std::snprintf(digits, sizeof digits, "%.1f", width_m);
    return std::string(digits);
  };
  std::map<std::pair<Kind, double>, Counts> together;
  std::map<std::size_t, Counts> false_of_log;
  Counts all_false;
  for (const auto& [key, counts] : counts_) {
    const auto& [log, kind, width_m] = key;
    row(logs_[log], name_of(kind), text(width_m), counts);
    together[{kind, width_m}] += counts;
    if (kind == Kind::kOverlapping) continue;
    false_of_log[log] += counts;
    all_false += counts;
  }
  for (const auto& [key, counts] : together) {
    row("all", name_of(key.first), text(key.second), counts);
  }
  for (const auto& [log, counts] : false_of_log) {
    row(logs_[log], "all but overlapping", "all", counts);
  }
  row("all", "all but overlapping", "all", all_false);
  std::fflush(out);
}

}  // namespace topogeo::bench
