// topogeo store merges, accept and refuse: what a localizer of several robots proposes to join.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/merge_conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "domain_view.hpp"
#include "service_request.hpp"
#include "service_table.hpp"
#include "store_commands.hpp"

namespace topogeo::cli {
namespace {

using localization::MergeProposal;
using std::chrono::milliseconds;

constexpr milliseconds kProposalPoll{20};

struct MergeRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::uint32_t number = 0;
  bool json = false;
  double wait_s = 5.0;

  [[nodiscard]] milliseconds patience() const {
    return milliseconds(static_cast<std::int64_t>(1000.0 * wait_s));
  }
};

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

/// As many as the status of the localizer counts: those that are sent to a late reader take a
/// while.
std::map<std::uint32_t, MergeProposal> receive(const messaging::Participant& participant,
                                               const MergeRequest& request) {
  messaging::Reader<msg::MergeProposal> reader(participant);
  messaging::Reader<msg::ServiceStatus> statuses(participant);
  std::map<std::uint32_t, MergeProposal> proposals;
  std::optional<double> expected;
  const auto end = std::chrono::steady_clock::now() + request.patience();
  while (std::chrono::steady_clock::now() < end) {
    statuses.take([&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.robot_id() != request.robot_id.c_str() ||
          status.service() != "localizer" || !reader.connected_with(info.writer)) {
        return;
      }
      expected = counter(&status, "merge_proposals");
    });
    reader.take([&](const msg::MergeProposal& message, const messaging::SampleInfo& info) {
      if (!info.valid || message.robot_id() != request.robot_id.c_str()) return;
      proposals[message.number()] = service::from_msg(message);
    });
    if (expected && static_cast<double>(proposals.size()) >= *expected) return proposals;
    static_cast<void>(statuses.wait_for_data(kProposalPoll));
  }
  if (!expected) throw std::runtime_error(nothing_alive(request.view, "localizer"));
  throw std::runtime_error(fmt::format("{} of {} proposals came within {} ms", proposals.size(),
                                       *expected, request.patience().count()));
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

int list_merges(const MergeRequest& request) {
  const messaging::Participant participant = join(request.view, "topogeo/merges");
  const auto proposals = receive(participant, request);
  if (request.json) {
    auto out = nlohmann::ordered_json::array();
    for (const auto& [number, proposal] : proposals) out.push_back(json_of(proposal));
    std::cout << out.dump(2) << '\n';
    return service::kOk;
  }
  if (proposals.empty()) std::cout << "no merge is proposed\n";
  for (const auto& [number, p] : proposals) {
    std::cout << fmt::format(
        "{}  {}: stop {} of {} is where stop {} of {} was\n"
        "   its map lies at x {:.2f} m, y {:.2f} m, heading {:.1f} degrees in the other\n"
        "   confidence {:.2f}: {} stops over {:.1f} m, {} matches of fitness {:.2f}, {:.0f} % of "
        "what they should show contradicts\n",
        number, state_text(p.state), p.place.stop.number, p.robot, p.place.other.number,
        p.other_robot, p.T_other_own.x_m, p.T_other_own.y_m,
        p.T_other_own.theta_rad * 180.0 / std::numbers::pi, p.confidence, p.stops, p.distance_m,
        p.matches, p.fitness, 100.0 * p.contradicted);
  }
  return service::kOk;
}

int answer_merge(const MergeRequest& request, bool accepted) {
  msg::MergeAnswer answer;
  messaging::set_header(answer, request.robot_id, 0, 0);
  answer.number(request.number);
  answer.accepted(accepted);
  const msg::LocalizationReply reply = ask<msg::LocalizationReply>(
      {request.view, request.robot_id, request.wait_s, "localizer of several robots"}, answer);
  (reply.accepted() ? std::cout : std::cerr)
      << (reply.accepted() ? "" : "topogeo: ") << reply.message().c_str() << '\n';
  return reply.accepted() ? service::kOk : service::kFailure;
}

void add_merge_options(command_line::Command& app, MergeRequest& request) {
  add_robot_option(app, request.robot_id, "whose map it is");
  add_domain_options(app, request.view);
  app.add_option("--wait-seconds", request.wait_s, "how long to wait for the localizer")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

}  // namespace

void add_store_merge_commands(command_line::Command& store, int& exit_code) {
  auto request = std::make_shared<MergeRequest>();
  command_line::Command* list = store.add_subcommand(
      "merges", "Which maps of robots that map one floor seem to show one place");
  add_merge_options(*list, *request);
  list->add_flag("--json", request->json, "print JSON");
  list->footer(
      "With localizer.merge: auto such maps become one by themselves; with ask they wait for\n"
      "topogeo store accept. A wrong merge is split by topogeo store remove-session.");
  list->callback([request, &exit_code] { exit_code = list_merges(*request); });
  for (const bool accepted : {true, false}) {
    command_line::Command* answer =
        accepted ? store.add_subcommand("accept", "The two maps of a proposed merge become one")
                 : store.add_subcommand("refuse", "They stay apart");
    answer->add_option("number", request->number, "of the proposal, as merges shows it")
        ->required()
        ->type_name("NUMBER");
    add_merge_options(*answer, *request);
    if (!accepted) {
      answer->footer("It is proposed again when the robots see another place, 10 m away or more.");
    }
    answer->callback(
        [request, accepted, &exit_code] { exit_code = answer_merge(*request, accepted); });
  }
}

}  // namespace topogeo::cli
