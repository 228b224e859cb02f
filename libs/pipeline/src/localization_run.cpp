#include "topogeo/pipeline/localization_run.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"

namespace topogeo::pipeline {

geometry::Pose2 parse_pose(const std::string& text) {
  std::array<double, 3> values{};
  std::size_t begin = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t end = i + 1 < values.size() ? text.find(',', begin) : text.size();
    std::size_t used = 0;
    bool good = end != std::string::npos && end > begin;
    try {
      if (good) values.at(i) = std::stod(text.substr(begin, end - begin), &used);
    } catch (const std::exception&) {
      good = false;
    }
    if (!good || used != end - begin || !std::isfinite(values.at(i))) {
      throw std::invalid_argument("pose '" + text +
                                  "': expected x,y,degrees in metres and degrees");
    }
    begin = end + 1;
  }
  constexpr double kMostDegrees = 36000.0;
  if (std::fabs(values[2]) > kMostDegrees) {
    throw std::invalid_argument("pose '" + text + "': expected at most 36000 degrees");
  }
  return {values[0], values[1], geometry::wrap_angle(values[2] * std::numbers::pi / 180.0)};
}

Eigen::Matrix3d given_pose_covariance() {
  constexpr double kSigma_m = 0.3;
  constexpr double kSigma_rad = 10.0 * std::numbers::pi / 180.0;
  return Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
      .asDiagonal();
}

std::shared_ptr<const localization::StoredMap> load_stored_map(const std::filesystem::path& file) {
  storage::MapDocument document = storage::read_map_file(file);
  const auto map = std::make_shared<localization::StoredMap>();
  map->maps = std::move(document.local_maps);
  map->trajectory = std::move(document.trajectory);
  map->maps.resize(map->trajectory.stops.size());
  for (const topomap::LocalMap& local_map : map->maps) {
    if (!local_map.points.empty()) return map;
  }
  throw std::runtime_error(file.string() + ": the map has no stop that saw anything");
}

std::string localization_csv(std::span<const localization::LocalizedStop> stops) {
  std::string text =
      "stop,stamp_s,x_m,y_m,theta_rad,state,confidence,sigma_x_m,sigma_y_m,sigma_theta_rad,"
      "believed_matches\n";
  for (const localization::LocalizedStop& s : stops) {
    const Eigen::Matrix3d& c = s.covariance;
    text += fmt::format("{},{},{:.6f},{:.6f},{:.6f},{},{:.4f},{:.4f},{:.4f},{:.4f},{}\n", s.id,
                        storage::stamp_text(s.stamp_ns), s.T_map_robot.x_m, s.T_map_robot.y_m,
                        s.T_map_robot.theta_rad, localization::to_string(s.belief.state),
                        s.belief.confidence, std::sqrt(c(0, 0)), std::sqrt(c(1, 1)),
                        std::sqrt(c(2, 2)), s.believed_matches);
  }
  return text;
}

storage::ReasonCounts localization_counts(const localization::MapLocalizer& localizer) {
  std::array<std::uint64_t, localization::kLocalizationStates> stops{};
  for (const localization::LocalizedStop& stop : localizer.stops()) {
    ++stops.at(static_cast<std::size_t>(stop.belief.state));
  }
  storage::ReasonCounts counts;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    counts.emplace_back(localization::to_string(static_cast<localization::LocalizationState>(i)),
                        stops.at(i));
  }
  counts.emplace_back("searches", localizer.searches());
  return counts;
}

}  // namespace topogeo::pipeline
