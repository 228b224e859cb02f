// Loop decisions and commands to the localizer.
#include <algorithm>

#include <Eigen/Cholesky>

#include "topogeo/matching/match_gate.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::finite;
using localization::LoopDecision;

namespace {

msg::LoopDecision to_wire(const LoopDecision& decision) {
  msg::LoopDecision out;
  out.step(decision.step);
  out.earlier_id(decision.earlier_id);
  out.later_id(decision.later_id);
  out.outcome(static_cast<msg::LoopOutcome>(decision.outcome));  // same values, see the IDL
  out.reason(static_cast<msg::MatchReason>(decision.reason));
  messaging::set_text_cut(out.explanation(), localization::explanation(decision));
  out.source(static_cast<msg::ProposalSource>(decision.source));  // same values, see the IDL
  out.T_earlier_later(to_msg(decision.T_earlier_later));
  out.T_predicted(to_msg(decision.predicted.T_a_b));
  out.predicted_covariance(to_msg(decision.predicted.covariance));
  out.correction_m(decision.correction_m);
  out.correction_rad(decision.correction_rad);
  out.fitness(decision.fitness);
  out.probability(decision.probability);
  return out;
}

LoopDecision from_wire(const msg::LoopDecision& decision) {
  check(decision.earlier_id() < decision.later_id(), "decisions.earlier_id", "less than later_id");
  check(decision.outcome() <= msg::kLoopOutvoted, "decisions.outcome", "0 to 4");
  check(decision.reason() <= msg::kReasonSecondSolution, "decisions.reason", "0 to 6");
  check(decision.source() <= msg::kSourceWindow, "decisions.source", "0 to 2");
  LoopDecision out;
  out.step = decision.step();
  out.earlier_id = decision.earlier_id();
  out.later_id = decision.later_id();
  out.outcome = static_cast<localization::LoopOutcome>(decision.outcome());
  out.reason = static_cast<localization::Reason>(decision.reason());
  out.T_earlier_later = from_msg(decision.T_earlier_later());
  out.predicted = {from_msg(decision.T_predicted()), from_msg(decision.predicted_covariance())};
  out.correction_m = finite(decision.correction_m(), "decisions.correction_m");
  out.correction_rad = finite(decision.correction_rad(), "decisions.correction_rad");
  out.fitness = finite(decision.fitness(), "decisions.fitness");
  out.probability = finite(decision.probability(), "decisions.probability");
  out.source = static_cast<localization::ProposalSource>(decision.source());
  return out;
}

}  // namespace

std::uint32_t decision_segment_count(std::size_t decisions) {
  return static_cast<std::uint32_t>((decisions + msg::kSegmentDecisions - 1) /
                                    msg::kSegmentDecisions);
}

msg::LoopDecisions to_segment(std::span<const LoopDecision> decisions, std::uint32_t segment,
                              std::string_view robot_id, std::int64_t stamp_ns,
                              std::uint64_t sequence_number, std::uint64_t numbered_since) {
  const std::size_t begin = std::size_t{segment} * msg::kSegmentDecisions;
  check(begin < decisions.size(), "segment", "less than the number of segments");
  const std::size_t size = std::min(std::size_t{msg::kSegmentDecisions}, decisions.size() - begin);
  msg::LoopDecisions out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.segment(segment);
  out.total(static_cast<std::uint32_t>(decisions.size()));
  out.numbered_since(numbered_since);
  for (const LoopDecision& decision : decisions.subspan(begin, size)) {
    out.decisions().push_back(to_wire(decision));
  }
  return out;
}

std::vector<LoopDecision> from_msg(const msg::LoopDecisions& message) {
  detail::check_segment(message.segment());
  const std::uint64_t begin = std::uint64_t{message.segment()} * msg::kSegmentDecisions;
  check(message.total() > begin, "total", "more decisions than before this segment");
  const std::uint64_t size =
      std::min<std::uint64_t>(msg::kSegmentDecisions, message.total() - begin);
  check(message.decisions().size() == size, "decisions", "every decision of the segment");
  std::vector<LoopDecision> out;
  out.reserve(size);
  for (const msg::LoopDecision& decision : message.decisions()) out.push_back(from_wire(decision));
  return out;
}

msg::LocalizationCommand to_msg(const LocalizationCommand& command, std::string_view robot_id,
                                std::int64_t stamp_ns, std::uint64_t sequence_number) {
  msg::LocalizationCommand out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.request_id(command.request_id);
  messaging::set_client_id(out, command.client_id);
  out.kind(command.kind);
  out.T_map_robot(to_msg(command.T_map_robot));
  out.covariance(to_msg(command.covariance));
  return out;
}

LocalizationCommand from_msg(const msg::LocalizationCommand& message) {
  check(message.kind() <= msg::kCommandSwitchToMapping, "kind", "0 to 3");
  LocalizationCommand command{message.request_id(), message.client_id().to_string(), message.kind(),
                              from_msg(message.T_map_robot()), from_msg(message.covariance())};
  if (command.kind == msg::kCommandSetPose) {
    const bool symmetric = command.covariance == command.covariance.transpose();
    check(symmetric && command.covariance.llt().info() == Eigen::Success, "covariance",
          "a symmetric positive definite matrix");
  }
  return command;
}

}  // namespace topogeo::service
