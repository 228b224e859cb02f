#include "store/merge_table.hpp"

#include <numbers>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using localization::MergeProposal;

const char* state_text(MergeProposal::State state) {
  switch (state) {
    case MergeProposal::State::kOpen:
      return "open";
    case MergeProposal::State::kAccepted:
      return "accepted";
    case MergeProposal::State::kRefused:
      return "refused";
    case MergeProposal::State::kWithdrawn:
      return "withdrawn";
  }
  return "?";
}

nlohmann::ordered_json json_of(const MergeProposal& p) {
  return {{"number", p.number},
          {"state", state_text(p.state)},
          {"robot", p.robot},
          {"other_robot", p.other_robot},
          {"stop", p.place.stop.number},
          {"session", fmt::format("{:016x}", p.place.stop.session)},
          {"other_stop", p.place.other.number},
          {"other_session", fmt::format("{:016x}", p.place.other.session)},
          {"x_m", p.T_other_own.x_m},
          {"y_m", p.T_other_own.y_m},
          {"theta_rad", p.T_other_own.theta_rad},
          {"confidence", p.confidence},
          {"stops", p.stops},
          {"distance_m", p.distance_m},
          {"matches", p.matches},
          {"fitness", p.fitness},
          {"contradicted", p.contradicted}};
}

}  // namespace

std::string MergeTable::progress() const {
  return fmt::format("{} of {:.0f} proposals", proposals_.size(), expected_.value_or(0.0));
}

std::string MergeTable::text() const {
  if (proposals_.empty()) return "no merge is proposed\n";
  std::string out;
  for (const auto& [number, p] : proposals_) {
    out += fmt::format(
        "{}  {}: stop {} of {} is where stop {} of {} was\n"
        "   its map lies at x {:.2f} m, y {:.2f} m, heading {:.1f} degrees in the other\n"
        "   confidence {:.2f}: {} stops over {:.1f} m, {} matches of fitness {:.2f}, {:.0f} % of "
        "what they should show contradicts\n",
        number, state_text(p.state), p.place.stop.number, p.robot, p.place.other.number,
        p.other_robot, p.T_other_own.x_m, p.T_other_own.y_m,
        p.T_other_own.theta_rad * 180.0 / std::numbers::pi, p.confidence, p.stops, p.distance_m,
        p.matches, p.fitness, 100.0 * p.contradicted);
  }
  return out;
}

std::string MergeTable::json() const {
  auto out = nlohmann::ordered_json::array();
  for (const auto& [number, proposal] : proposals_) out.push_back(json_of(proposal));
  return out.dump(2) + "\n";
}

}  // namespace topogeo::cli
