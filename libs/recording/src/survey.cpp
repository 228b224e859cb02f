#include "topogeo/recording/survey.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::recording {
namespace {

/// Scans with one pattern of beams.
struct BeamKind {
  ros::BeamPattern upright;
  ros::BeamPattern upside_down;
  std::uint64_t scans = 0;
};

struct TopicFacts {
  Topic topic;
  std::uint64_t messages = 0;
  std::vector<BeamKind> beams;  // of its scans
  std::string frame;            // from the first message: of the laser, or of odometry
  std::string child_frame;      // from the first odometry
};

bool is_used(const Topic& topic) {
  return topic.encoding != Encoding::kOther &&
         (topic.type == kLaserScanType || topic.type == kOdometryType || topic.type == kTfType);
}

/// Collects the scans and odometry of all candidate topics, and all transforms.
class Surveyor {
 public:
  Surveyor(const std::filesystem::path& path, const TopicChoice& choice)
      : name_(path.string()), choice_(choice) {
    const std::unique_ptr<MessageSource> source = open_messages(path, is_used);
    RawMessage message;
    while (source->next(message)) take(source->topics()[message.topic], message);
    for (const Topic& topic : source->topics()) all_topics_.push_back(topic);
    damage_ = source->damage();
  }

  Survey result() {
    choose_scans();
    choose_odometry();
    find_mounting();
    choose_beams();
    return std::move(survey_);
  }

 private:
  void take(const Topic& topic, const RawMessage& message);
  void choose_scans();
  void choose_odometry();
  void use_transforms(const std::string& topic);
  void find_mounting();
  void choose_beams();
  [[nodiscard]] std::vector<const TopicFacts*> of_type(std::string_view type) const;
  [[nodiscard]] std::string topics_text() const;

  std::string name_;
  const TopicChoice& choice_;
  std::map<std::string, TopicFacts> facts_;  // by name
  std::vector<Topic> all_topics_;
  std::string damage_;
  ros::FrameTree transforms_;
  Survey survey_;
};

void count_beams(std::vector<BeamKind>& kinds, const ros::LaserScan& scan) {
  constexpr std::size_t kMostKinds = 256;
  constexpr std::size_t kMostBeams = scan::CarmenLogReader::kMaxBeams;
  const ros::BeamPattern upright = ros::pattern_of(scan, false, kMostBeams);
  for (BeamKind& kind : kinds) {
    if (!ros::same_beams(kind.upright, upright)) continue;
    ++kind.scans;
    return;
  }
  if (kinds.size() < kMostKinds) {
    kinds.push_back({upright, ros::pattern_of(scan, true, kMostBeams), 1});
  }
}

void Surveyor::take(const Topic& topic, const RawMessage& message) {
  TopicFacts& facts = facts_[topic.name];
  facts.topic = topic;
  ++facts.messages;
  try {
    if (topic.type == kTfType) {
      transforms_.add(decode<ros::TFMessage>(message.data, topic.encoding),
                      topic.name.ends_with("tf_static"));
    } else if (topic.type == kLaserScanType) {
      const auto scan = decode<ros::LaserScan>(message.data, topic.encoding);
      if (facts.frame.empty()) facts.frame = ros::frame_name(scan.header_().frame_id_());
      count_beams(facts.beams, scan);
    } else if (facts.frame.empty()) {
      const auto odometry = decode<ros::Odometry>(message.data, topic.encoding);
      facts.frame = ros::frame_name(odometry.header_().frame_id_());
      facts.child_frame = ros::frame_name(odometry.child_frame_id_());
    }
  } catch (const DecodeError&) {
    // The log reader counts and explains them.
  } catch (const std::invalid_argument&) {  // NOLINT(bugprone-empty-catch): as those
  }
}

/// Sorted by number of messages, most first.
std::vector<const TopicFacts*> Surveyor::of_type(std::string_view type) const {
  std::vector<const TopicFacts*> found;
  for (const auto& [name, facts] : facts_) {
    if (facts.topic.type == type) found.push_back(&facts);
  }
  std::ranges::stable_sort(
      found, [](const TopicFacts* a, const TopicFacts* b) { return a->messages > b->messages; });
  return found;
}

std::string Surveyor::topics_text() const {
  std::string text;
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(all_topics_.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + all_topics_[i].name + " (" + all_topics_[i].type + ")";
  }
  if (all_topics_.size() > kMost) text += ", ...";
  if (text.empty()) text = "no topics";
  return damage_.empty() ? text : text + "; " + damage_;
}

const TopicFacts* chosen(const std::vector<const TopicFacts*>& found,
                         const std::optional<std::string>& wanted, std::string_view usual) {
  const std::string name = wanted.value_or(std::string(usual));
  const auto named = std::ranges::find_if(
      found, [&](const TopicFacts* facts) { return facts->topic.name == name; });
  if (named != found.end()) return *named;
  return wanted || found.empty() ? nullptr : found.front();
}

std::string others_text(const std::vector<const TopicFacts*>& found, const TopicFacts* used) {
  std::string text;
  for (const TopicFacts* facts : found) {
    if (facts == used) continue;
    text += (text.empty() ? ", not " : ", ") + facts->topic.name + " (" +
            std::to_string(facts->messages) + ")";
  }
  return text;
}

void Surveyor::choose_scans() {
  const std::vector<const TopicFacts*> found = of_type(kLaserScanType);
  const TopicFacts* used = chosen(found, choice_.scan, "/scan");
  if (used == nullptr) {
    throw std::runtime_error(name_ + ": expected laser scans (sensor_msgs/LaserScan)" +
                             (choice_.scan ? " on " + *choice_.scan : "") + ", got " +
                             topics_text());
  }
  survey_.scan_topic = used->topic.name;
  survey_.laser_frame = used->frame;
  survey_.scans = used->messages;
  survey_.notes.push_back("scans from " + used->topic.name + " (" + std::to_string(used->messages) +
                          ")" + others_text(found, used));
}

void Surveyor::choose_odometry() {
  const std::vector<const TopicFacts*> found = of_type(kOdometryType);
  const TopicFacts* used = chosen(found, choice_.odometry, "/odom");
  if (used != nullptr) {
    survey_.odometry_topic = used->topic.name;
    survey_.odom_frame = used->frame;
    survey_.robot_frame = used->child_frame;
    survey_.notes.push_back("odometry from " + used->topic.name + " (" +
                            std::to_string(used->messages) + ")" + others_text(found, used));
    return;
  }
  const std::vector<const TopicFacts*> transforms = of_type(kTfType);
  const TopicFacts* topic = chosen(transforms, choice_.odometry, "/tf");
  if (topic != nullptr) use_transforms(topic->topic.name);
  if (survey_.odometry_topic.empty()) {
    throw std::runtime_error(
        name_ + ": expected odometry (nav_msgs/Odometry, or transforms odom -> base_link on /tf)" +
        (choice_.odometry ? " on " + *choice_.odometry : "") + ", got " + topics_text());
  }
}

/// Rank of this transform as a candidate for the odometry's; 0: it is none.
int odometry_rank(const ros::FrameTree::Edge& edge) {
  const std::string parent = edge.parent.substr(edge.parent.rfind('/') + 1);
  const std::string child = edge.child.substr(edge.child.rfind('/') + 1);
  if (edge.is_static || !parent.starts_with("odom")) return 0;
  if (child == "base_link") return 3;
  return child == "base_footprint" ? 2 : 1;
}

void Surveyor::use_transforms(const std::string& topic) {
  const std::vector<ros::FrameTree::Edge>& edges = transforms_.edges();
  const auto best = std::ranges::max_element(edges, {}, odometry_rank);
  if (best == edges.end() || odometry_rank(*best) == 0) return;
  survey_.odometry_topic = topic;
  survey_.odometry_from_tf = true;
  survey_.odom_frame = best->parent;
  survey_.robot_frame = best->child;
  survey_.notes.push_back("odometry from " + topic + ", " + best->parent + " -> " + best->child +
                          " (" + std::to_string(best->count) + ")");
}

void Surveyor::find_mounting() {
  const std::string frames = survey_.robot_frame + " -> " + survey_.laser_frame;
  if (survey_.robot_frame == survey_.laser_frame) {
    survey_.mounting = ros::LaserMounting{};
    return;
  }
  const auto T_robot_laser = transforms_.find(survey_.robot_frame, survey_.laser_frame);
  if (!T_robot_laser) {
    survey_.notes.push_back("no transforms " + frames + ": the mounting of the laser is unknown");
    return;
  }
  survey_.mounting = ros::planar_mounting(*T_robot_laser);
  if (survey_.mounting->upside_down) survey_.notes.push_back("the laser is mounted upside down");
  if (survey_.mounting->tilt_rad > ros::kLargestTilt_rad) {
    survey_.notes.push_back(
        "the laser is tilted by " +
        std::to_string(std::lround(survey_.mounting->tilt_rad * 180.0 / std::numbers::pi)) +
        " degrees (" + frames + "): its ranges are used as if it were level");
  }
}

/// Chooses the beams of most scans; the first pattern breaks ties.
void Surveyor::choose_beams() {
  const std::vector<BeamKind>& kinds = facts_.at(survey_.scan_topic).beams;
  const auto most = std::ranges::max_element(kinds, {}, &BeamKind::scans);
  if (most == kinds.end()) return;
  survey_.beams =
      survey_.mounting && survey_.mounting->upside_down ? most->upside_down : most->upright;
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
