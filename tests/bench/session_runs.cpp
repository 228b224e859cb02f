#include "session_runs.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/laser_mounting.hpp"
#include "topogeo/session/mapping_session.hpp"

namespace topogeo::bench {

using geometry::Pose2;

namespace {

/// The rigid motion that best moves the points `b` onto `a`.
Pose2 fitted(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  Eigen::Vector2d mean_a = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_b = Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  double along = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d p = a[i] - mean_a;
    const Eigen::Vector2d q = b[i] - mean_b;
    along += p.dot(q);
    across += q.x() * p.y() - q.y() * p.x();
  }
  const double turn = std::atan2(across, along);
  const Pose2 rotation{0.0, 0.0, turn};
  const Pose2 moved = rotation * Pose2{mean_b.x(), mean_b.y(), 0.0};
  return {mean_a.x() - moved.x_m, mean_a.y() - moved.y_m, turn};
}

void relate(const storage::MapDocument& own, const storage::MapDocument& joint,
            std::size_t stored_stops, SessionPair& pair) {
  std::vector<Eigen::Vector2d> in_joint;
  std::vector<Eigen::Vector2d> in_own;
  const std::size_t skipped = pair.stops - pair.joined;
  for (std::size_t i = 0; i < pair.joined; ++i) {
    in_joint.push_back(joint.trajectory.stops[stored_stops + i].T_map_robot.position_m());
    in_own.push_back(own.trajectory.stops[skipped + i].T_map_robot.position_m());
  }
  if (in_own.size() < 2) return;
  pair.T_stored_later = fitted(in_joint, in_own);
  double sum = 0.0;
  for (std::size_t i = 0; i < in_own.size(); ++i) {
    const Pose2 p = pair.T_stored_later * Pose2{in_own[i].x(), in_own[i].y(), 0.0};
    sum += (p.position_m() - in_joint[i]).squaredNorm();
  }
  pair.spread_m = std::sqrt(sum / static_cast<double>(in_own.size()));
}

void note_followed(const pipeline::MappingRun& run, const topomap::Trajectory& own, double path_m,
                   SessionPair& pair) {
  const localization::MapTracker* tracker =
      run.session() == nullptr ? nullptr : run.session()->map_tracker();
  if (tracker == nullptr) return;
  for (std::size_t i = pair.followed.size(); i < tracker->stops().size(); ++i) {
    const localization::LocalizedStop& stop = tracker->stops()[i];
    pair.followed.push_back({stop.status.state,
                             stop.T_map_robot * geometry::inverse(own.stops[i].T_map_robot), path_m,
                             std::nullopt});
    if (tracker->last_step()) {
      pair.followed.back().contradicted =
          localization::contradiction(tracker->last_step()->evidence);
    }
  }
}

}  // namespace

SessionDrive session_drive(const std::string& log_file, const std::string& name,
                           pipeline::LoadedConfig config) {
  static_cast<void>(pipeline::choose_mounting(config, scan::mounting_in_log(log_file)));
  SessionDrive drive{name, config.config, {}, {}};
  scan::CarmenLogReader reader(log_file, config.config.log);
  while (auto scan = reader.next()) drive.scans.push_back(std::move(*scan));
  pipeline::MappingRun run(drive.config, "robot");
  for (const scan::Scan& scan : drive.scans) run.add(scan);
  drive.map = run.finish();
  return drive;
}

SessionPair run_pair(const std::vector<SessionDrive>& drives, std::size_t stored,
                     std::size_t later) {
  const SessionDrive& before = drives[stored];
  const SessionDrive& after = drives[later];
  SessionPair pair;
  pair.stored = stored;
  pair.later = later;
  pair.stops = after.map.local_maps.size();
  const auto map = std::make_shared<const storage::MapDocument>(before.map);
  pipeline::MappingRun run(after.config, "robot", map, std::nullopt);
  double path_m = 0.0;
  for (std::size_t i = 0; i < after.scans.size(); ++i) {
    if (i > 0) {
      path_m +=
          (after.scans[i].T_odom_robot.position_m() - after.scans[i - 1].T_odom_robot.position_m())
              .norm();
    }
    run.add(after.scans[i]);
    note_followed(run, after.map.trajectory, path_m, pair);
    if (!pair.joined_after_m && run.session()->map_tracker() == nullptr) {
      pair.joined_after_m = path_m;
    }
  }
  const storage::MapDocument joint = run.finish();
  pair.joined = joint.local_maps.size() - before.map.local_maps.size();
  if (pair.joined > 0 && !pair.joined_after_m) pair.joined_after_m = path_m;
  relate(after.map, joint, before.map.local_maps.size(), pair);
  return pair;
}

std::vector<SessionCycle> cycles_of(const std::vector<SessionPair>& pairs, std::size_t drives) {
  const auto pair_of = [&](std::size_t stored, std::size_t later) -> const SessionPair* {
    for (const SessionPair& pair : pairs) {
      if (pair.stored == stored && pair.later == later) {
        return pair.joined_after_m ? &pair : nullptr;
      }
    }
    return nullptr;
  };
  std::vector<SessionCycle> cycles;
  for (std::size_t a = 0; a < drives; ++a) {
    for (std::size_t b = a + 1; b < drives; ++b) {
      for (std::size_t c = a + 1; c < drives; ++c) {
        if (b == c) continue;
        const SessionPair* ab = pair_of(a, b);
        const SessionPair* bc = pair_of(b, c);
        const SessionPair* ca = pair_of(c, a);
        if (ab == nullptr || bc == nullptr || ca == nullptr) continue;
        const Pose2 round = ab->T_stored_later * bc->T_stored_later * ca->T_stored_later;
        cycles.push_back({{a, b, c}, round.position_m().norm(), std::fabs(round.theta_rad)});
      }
    }
  }
  return cycles;
}

}  // namespace topogeo::bench
