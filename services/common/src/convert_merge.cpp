// Proposals to merge the maps of two robots.
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/merge_conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

msg::MergeProposal to_msg(const localization::MergeProposal& proposal, std::string_view robot_id,
                          std::int64_t stamp_ns, std::uint64_t sequence_number) {
  msg::MergeProposal out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.number(proposal.number);
  out.state(static_cast<msg::MergeState>(proposal.state));  // same values, see the IDL
  messaging::set_text(out.robot(), proposal.robot, "robot");
  messaging::set_text(out.other_robot(), proposal.other_robot, "other_robot");
  out.stop(to_msg(proposal.place.stop));
  out.other_stop(to_msg(proposal.place.other));
  out.T_other_own(to_msg(proposal.T_other_own));
  out.confidence(proposal.confidence);
  out.stops(proposal.stops);
  out.distance_m(proposal.distance_m);
  out.matches(proposal.matches);
  out.fitness(proposal.fitness);
  out.contradicted(proposal.contradicted);
  return out;
}

localization::MergeProposal from_msg(const msg::MergeProposal& message) {
  using detail::finite;
  detail::check(message.state() <= msg::kMergeWithdrawn, "state", "0 to 3");
  localization::MergeProposal out;
  out.number = message.number();
  out.state = static_cast<localization::MergeProposal::State>(message.state());
  out.robot = message.robot().to_string();
  out.other_robot = message.other_robot().to_string();
  out.place.stop = from_msg(message.stop());
  out.place.other = from_msg(message.other_stop());
  out.T_other_own = from_msg(message.T_other_own());
  out.confidence = finite(message.confidence(), "confidence");
  out.stops = message.stops();
  out.distance_m = finite(message.distance_m(), "distance_m");
  out.matches = message.matches();
  out.fitness = finite(message.fitness(), "fitness");
  out.contradicted = finite(message.contradicted(), "contradicted");
  return out;
}

}  // namespace topogeo::service
