// Proposals to make the maps of two robots one, out to whoever wants to answer, and the answers.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "topogeo/localization/session/merge_proposals.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/merge.h"
#include "topogeo/service/service.hpp"

#include "localizer_commands.hpp"
#include "reply_sender.hpp"

namespace topogeo::localizer {

class MergeChannel {
 public:
  using Handler = std::function<CommandAnswer(std::uint32_t number, bool accepted)>;

  /// `on_arrival` is called for every answer; carry_out() then is to be called soon. Commands that
  /// are for the localizer of one robot are refused. Throws like Reader and Writer.
  MergeChannel(service::Service& service, std::function<void()> on_arrival);

  /// Sends those that are new or have changed. `stamp_ns` is that of the last stop.
  void publish(const std::vector<localization::MergeProposal>& proposals, std::int64_t stamp_ns);
  /// Gives the answers that have come to the handler, in order, and sends what became of them.
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
