// topogeo store merges, accept and refuse: the merges proposed by a localizer of several robots.
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/merge_conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/patience.hpp"

#include "common/domain_view.hpp"
#include "common/service_request.hpp"
#include "common/service_table.hpp"
#include "store/merge_table.hpp"
#include "store/store_commands.hpp"

namespace topogeo::cli {
namespace {

constexpr std::chrono::milliseconds kProposalPoll{20};

struct MergeRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::uint32_t number = 0;
  bool json = false;
  double wait_s = 5.0;
};

MergeTable receive(const messaging::Participant& participant, const MergeRequest& request) {
  messaging::Reader<msg::MergeProposal> reader(participant);
  messaging::Reader<msg::ServiceStatus> statuses(participant);
  MergeTable table;
  support::Patience patience(request.wait_s, support::monotonic_s());
  while (!table.is_complete() && !patience.is_over(support::monotonic_s())) {
    static_cast<void>(statuses.wait_for_data(kProposalPoll));
    statuses.take([&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.robot_id() != request.robot_id.c_str() ||
          status.service() != "localizer" || !reader.connected_with(info.writer)) {
        return;
      }
      table.expect(counter(&status, "merge_proposals"));
    });
    reader.take([&](const msg::MergeProposal& message, const messaging::SampleInfo& info) {
      if (!info.valid || message.robot_id() != request.robot_id.c_str()) return;
      table.put(service::from_msg(message));
    });
  }
  if (table.is_complete()) return table;
  const std::string reason = patience.reason();
  if (!table.has_localizer()) {
    throw std::runtime_error(nothing_alive(request.view, "localizer") + reason);
  }
  throw std::runtime_error(
      fmt::format("{} came within {:.1f} s{}", table.progress(), request.wait_s, reason));
}

int list_merges(const MergeRequest& request) {
  const messaging::Participant participant =
      join_for(request.view, "topogeo/merges", request.robot_id);
  const MergeTable table = receive(participant, request);
  std::cout << (request.json ? table.json() : table.text());
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
  add_robot_option(app, request.robot_id, "robot of the map");
  add_domain_options(app, request.view);
  app.add_option("--wait-seconds", request.wait_s, "how long to wait for the localizer")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

}  // namespace

void add_store_merge_commands(command_line::Command& store, int& exit_code) {
  auto request = std::make_shared<MergeRequest>();
  command_line::Command* list =
      store.add_subcommand("merges", "List the proposed merges of maps of one floor");
  add_merge_options(*list, *request);
  list->add_flag("--json", request->json, "print JSON");
  list->footer(
      "With localizer.merge: auto such maps become one by themselves; with ask they wait for\n"
      "topogeo store accept. A wrong merge is split by topogeo store remove-session.");
  list->callback([request, &exit_code] { exit_code = list_merges(*request); });
  for (const bool accepted : {true, false}) {
    command_line::Command* answer =
        accepted ? store.add_subcommand("accept", "Merge the two maps of a proposal")
                 : store.add_subcommand("refuse", "Keep the two maps of a proposal separate");
    answer->add_option("number", request->number, "number of the proposal, as shown by merges")
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
