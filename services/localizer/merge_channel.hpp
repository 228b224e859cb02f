// Proposals to merge the maps of two robots: publishes them and receives the answers.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/service/service.hpp"
#include "topogeo/session/merge_proposals.hpp"

#include "localizer_commands.hpp"
#include "reply_sender.hpp"

namespace topogeo::localizer {

class MergeChannel {
 public:
  using Handler = std::function<CommandAnswer(std::uint32_t number, bool accepted)>;

  /// `on_arrival` is called for every answer; call carry_out() soon after. Commands for the
  /// localizer of one robot are refused. Throws like Reader and Writer.
  MergeChannel(service::Service& service, std::function<void()> on_arrival);

  /// Sends new and changed proposals. `stamp_ns` is the stamp of the last stop.
  void publish(const std::vector<localization::MergeProposal>& proposals, std::int64_t stamp_ns);
  /// Passes the answers that have arrived to the handler, in order, and sends the outcomes.
  void carry_out(const Handler& handler, std::int64_t stamp_ns);

 private:
  service::Service& service_;
  std::function<void()> on_arrival_;
  messaging::Writer<msg::MergeProposal> proposals_;
  ReplySender replies_;
  std::deque<msg::MergeAnswer> waiting_;
  std::vector<msg::MergeProposal> sent_;
  std::uint64_t sent_count_ = 0;
};

}  // namespace topogeo::localizer
