#include "channels/protocol_names.hpp"

#include <array>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

namespace topogeo::web {
namespace {

using std::string_view;

/// Word for an enumeration value; `words` are in the order of the values.
template <class Enum, std::size_t size>
string_view word(const std::array<string_view, size>& words, Enum value) {
  const auto number = static_cast<std::size_t>(value);
  return number < size ? words.at(number) : string_view("unknown");
}

}  // namespace

string_view name_of(msg::LocalizationState state) {
  static_assert(localization::kLocalizationStates == msg::kStateLost + 1);
  const auto number = static_cast<std::size_t>(state);
  if (number >= localization::kLocalizationStates) return "unknown";
  return localization::to_string(static_cast<localization::LocalizationState>(number));
}

string_view name_of(msg::NavigatorState state) {
  static_assert(static_cast<std::size_t>(navigation::NavigatorState::kStopped) ==
                msg::kNavigatorStopped);
  return navigation::describe(static_cast<navigation::NavigatorState>(state));
}

string_view name_of(msg::HaltReason reason) {
  static constexpr std::array<string_view, 14> kWords = {
      "none",         "waits_for_route", "no_route",       "cancelled", "paused",
      "pose_lost",    "no_map",          "outside_map",    "obstacle",  "no_scan",
      "sonar_silent", "no_odometry",     "base_not_ready", "base_stuck"};
  static_assert(kWords.size() == msg::kHaltBaseStuck + 1);
  return word(kWords, reason);
}

string_view name_of(msg::BaseState state) {
  static constexpr std::array<string_view, 10> kWords = {
      "ready",  "moving",           "offline", "starting", "emergency_stop",
      "halted", "watchdog_expired", "bumped",  "joystick", "motors_off"};
  static_assert(kWords.size() == msg::kBaseMotorsOff + 1);
  return word(kWords, state);
}

string_view name_of(msg::LaserState state) {
  static constexpr std::array<string_view, 4> kWords = {"running", "offline", "starting", "fault"};
  static_assert(kWords.size() == msg::kLaserFault + 1);
  return word(kWords, state);
}

string_view name_of(msg::NodeKind kind) {
  static_assert(static_cast<std::size_t>(topomap::NodeKind::kHallCorridor) ==
                msg::kNodeHallCorridor);
  return topomap::name_of(static_cast<topomap::NodeKind>(kind));
}

string_view name_of(msg::LoopOutcome outcome) {
  static constexpr std::array<string_view, 5> kWords = {"accepted", "gate", "unconfirmed",
                                                        "no_closing", "outvoted"};
  static_assert(kWords.size() == msg::kLoopOutvoted + 1);
  return word(kWords, outcome);
}

string_view name_of(msg::ProposalSource source) {
  static constexpr std::array<string_view, 3> kWords = {"prediction", "place", "window"};
  static_assert(kWords.size() == msg::kSourceWindow + 1);
  return word(kWords, source);
}

string_view name_of(msg::MatchReason reason) {
  static constexpr std::array<string_view, 7> kWords = {
      "none",     "nothing_in_common", "little_overlap", "few_inliers",
      "doubtful", "implausible",       "second_solution"};
  static_assert(kWords.size() == msg::kReasonSecondSolution + 1);
  return word(kWords, reason);
}

string_view name_of(msg::ServiceState state) {
  static constexpr std::array<string_view, 6> kWords = {"starting", "waiting", "running",
                                                        "finished", "failed",  "stopped"};
  static_assert(kWords.size() == msg::kServiceStopped + 1);
  return word(kWords, state);
}

string_view name_of(msg::MergeState state) {
  static constexpr std::array<string_view, 4> kWords = {"open", "accepted", "refused", "withdrawn"};
  static_assert(kWords.size() == msg::kMergeWithdrawn + 1);
  return word(kWords, state);
}

std::string reason_of(msg::LocalizationState state) {
  switch (state) {
    case msg::kStateTracking:
      return "The laser fits the map.";
    case msg::kStateAmbiguous:
      return "Not sure where it is: the laser fits more than one place, or none.";
    case msg::kStateSearching:
      return "Looking for its place on the map. Drive it on, or set its position.";
    case msg::kStateLost:
      return "The laser contradicts this place. Set the position, or search the whole map.";
  }
  return {};
}

}  // namespace topogeo::web
