#include "topogeo/recording/survey.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "recording_facts.hpp"
#include "robot_frame.hpp"
#include "topic_selection.hpp"

namespace topogeo::recording {
namespace {

/// Rank of this transform as a candidate for the odometry's; 0: it is none.
int odometry_rank(const ros::FrameTree::Edge& edge) {
  const std::string child = name_without_prefix(edge.child);
  if (edge.is_static || !name_without_prefix(edge.parent).starts_with("odom")) return 0;
  if (child == "base_link") return 3;
  return child == "base_footprint" ? 2 : 1;
}

/// For a wrong name of a topic.
std::string laser_topics_text(const RecordingFacts& facts) {
  std::string text;
  for (const TopicFacts* topic : facts.of_type(kLaserScanType)) {
    text += (text.empty() ? "; scans are on " : ", ") + topic->topic.name + " (" +
            std::to_string(topic->messages) + ")";
  }
  return text;
}

/// The node that turns other data of a laser into scans, for a recording without these.
std::string converter_text(const RecordingFacts& facts) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kConverters = {
      std::pair{"sensor_msgs/msg/MultiEchoLaserScan", "laser_proc"},
      std::pair{"sensor_msgs/msg/PointCloud2", "pointcloud_to_laserscan"}};
  for (const auto& [type, node] : kConverters) {
    const std::optional<Topic> topic = facts.any_of_type(type);
    if (!topic) continue;
    return "; play it with the node " + std::string(node) + ", which makes scans of " +
           topic->name + ", and record these with odometry, /tf and /tf_static";
  }
  return {};
}

class Surveyor {
 public:
  Surveyor(const std::filesystem::path& path, const TopicChoice& choice)
      : name_(path.string()), choice_(choice), facts_(path) {}

  Survey result() {
    choose_scans();
    choose_odometry();
    find_units();
    find_mounting();
    if (!survey_.mounting && choice_.T_robot_laser) {
      survey_.mounting = ros::LaserMounting{.T_robot_laser = *choice_.T_robot_laser};
    }
    survey_.upside_down =
        choice_.upside_down || (survey_.mounting && survey_.mounting->upside_down);
    choose_beams();
    return std::move(survey_);
  }

 private:
  void choose_scans();
  void choose_odometry();
  void use_transforms(const TopicFacts& topic);
  void find_units();
  void find_mounting();
  void choose_beams();

  std::string name_;
  const TopicChoice& choice_;
  RecordingFacts facts_;
  Stream scans_;
  ros::FrameTree transforms_;  // of the robot with these scans
  Survey survey_;
};

void Surveyor::choose_scans() {
  const std::optional<Stream> used = recording::choose_scans(facts_, choice_);
  if (!used) {
    throw std::runtime_error(name_ + ": expected laser scans (sensor_msgs/LaserScan)" +
                             (choice_.scan ? " on " + *choice_.scan : "") + ", got " +
                             facts_.topics_text() + laser_topics_text(facts_) +
                             converter_text(facts_));
  }
  scans_ = *used;
  transforms_ = transforms_for(facts_, scans_);
  survey_.scan_topic = used->topic->topic.name;
  if (used->frames != nullptr) survey_.laser_frame = used->frames->frame;
  survey_.scans = used->topic->messages;
  survey_.notes.push_back("scans from " + text_of(facts_, *used, "--scan-topic"));
}

void Surveyor::choose_odometry() {
  if (choice_.odometry_use == OdometryUse::kIgnored) return;
  const std::optional<Stream> used = recording::choose_odometry(facts_, choice_, scans_);
  if (used) {
    survey_.odometry_topic = used->topic->topic.name;
    survey_.odometry_type = used->topic->topic.type;
    if (used->frames != nullptr) {
      survey_.odom_frame = used->frames->frame;
      survey_.odometry_child_frame = used->frames->child;
    }
    survey_.notes.push_back("odometry from " + text_of(facts_, *used, "--odometry-topic"));
    return;
  }
  const TopicFacts* topic = choose_transforms(facts_, choice_, scans_);
  if (topic != nullptr) use_transforms(*topic);
  if (!survey_.odometry_topic.empty()) return;
  if (choice_.odometry || choice_.odometry_use == OdometryUse::kRequired) {
    throw std::runtime_error(
        name_ + ": expected odometry (nav_msgs/Odometry, or transforms odom -> base_link on /tf)" +
        (choice_.odometry ? " on " + *choice_.odometry : "") + ", got " + facts_.topics_text());
  }
}

/// Prefers the frame that carries the laser.
void Surveyor::use_transforms(const TopicFacts& topic) {
  const std::vector<ros::FrameTree::Edge>& edges = topic.transforms.edges();
  const auto best = std::ranges::max_element(edges, {}, [this](const ros::FrameTree::Edge& edge) {
    const int rank = odometry_rank(edge);
    if (rank == 0) return std::pair(false, 0);
    return std::pair(transforms_.find(edge.child, survey_.laser_frame).has_value(), rank);
  });
  if (best == edges.end() || odometry_rank(*best) == 0) return;
  survey_.odometry_topic = topic.topic.name;
  survey_.odometry_type = kTfType;
  survey_.odom_frame = best->parent;
  survey_.odometry_child_frame = best->child;
  survey_.notes.push_back("odometry from " + topic.topic.name + ", " + best->parent + " -> " +
                          best->child + " (" + std::to_string(best->count) + ")");
}

void Surveyor::find_units() {
  if (scans_.frames == nullptr) return;
  if (scans_.frames->scans_in_degrees > 0) {
    survey_.notes.push_back("the angles of " + std::to_string(scans_.frames->scans_in_degrees) +
                            " scans are in degrees: they are converted");
  }
  survey_.ranges_in_millimetres = scans_.frames->range_unit.is_millimetres();
  if (survey_.ranges_in_millimetres) {
    survey_.notes.push_back("the ranges are in millimetres (up to " +
                            std::to_string(std::lround(scans_.frames->range_unit.largest())) +
                            "): they are converted");
  }
}

void Surveyor::find_mounting() {
  const RobotFrame robot = find_robot_frame(
      transforms_, {survey_.odom_frame, survey_.odometry_child_frame}, survey_.laser_frame);
  survey_.robot_frame = robot.name;
  if (survey_.odometry_topic.empty() && !robot.T_robot_laser) {
    survey_.robot_frame = survey_.laser_frame;
    survey_.mounting = ros::LaserMounting{};
    return;
  }
  if (!robot.note.empty()) survey_.notes.push_back(robot.note);
  if (!robot.T_robot_laser) return;
  survey_.mounting = ros::planar_mounting(*robot.T_robot_laser);
  if (survey_.mounting->upside_down) survey_.notes.emplace_back("the laser is mounted upside down");
  if (survey_.mounting->tilt_rad > ros::kLargestTilt_rad) {
    survey_.notes.push_back(
        "the laser is tilted by " +
        std::to_string(std::lround(survey_.mounting->tilt_rad * 180.0 / std::numbers::pi)) +
        " degrees (" + robot.name + " -> " + survey_.laser_frame +
        "): its ranges are used as if it were level");
  }
}

/// Chooses the beams of most scans; the first pattern breaks ties.
void Surveyor::choose_beams() {
  if (scans_.frames == nullptr) return;
  const std::vector<BeamKind>& kinds = scans_.frames->beams;
  const auto most = std::ranges::max_element(kinds, {}, &BeamKind::scans);
  if (most == kinds.end()) return;
  survey_.beams = survey_.upside_down ? most->upside_down : most->upright;
  std::uint64_t alike = 0;
  std::uint64_t others = 0;
  for (const BeamKind& kind : kinds) {
    if (&kind == &*most) continue;
    (ros::alike(kind.upright, most->upright) ? alike : others) += kind.scans;
  }
  const std::string pattern = text_of(*survey_.beams);
  if (alike > 0) {
    survey_.notes.push_back(std::to_string(alike) + " scans have other beams than " + pattern +
                            ": they are put on these");
  }
  if (others > 0) {
    survey_.notes.push_back(std::to_string(others) + " scans have other beams than " + pattern +
                            " and share less than half of the field of view, or have another step: "
                            "they are left out");
  }
}

}  // namespace

Survey survey(const std::filesystem::path& path, const TopicChoice& choice) {
  return Surveyor(path, choice).result();
}

}  // namespace topogeo::recording
