// A request to a running service and its reply.
#pragma once

#include <chrono>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/patience.hpp"

#include "common/domain_view.hpp"

namespace topogeo::cli {

struct ServicePeer {
  const DomainView& view;
  const std::string& robot_id;
  double wait_s;
  std::string what = "localizer";  ///< for people
};

/// Sends `request`, with a new id, until the service has replied: the first reply may be sent
/// before the service knows this reader. It carries out a request once and repeats the reply.
/// Throws std::runtime_error when there is no reply.
template <class Reply, class Request>
Reply ask(const ServicePeer& peer, Request request) {
  constexpr double kAgain_s = 1.0;
  constexpr std::chrono::milliseconds kReplyPoll{100};
  messaging::set_client_id(request, support::process_name());
  request.request_id(std::random_device{}());
  const messaging::Participant participant = join(peer.view, "topogeo/" + peer.what);
  messaging::Writer<Request> requests(participant);
  messaging::Reader<Reply> replies(participant);
  support::Patience connecting(peer.wait_s, support::monotonic_s());
  while (!requests.wait_for_matched(1, kReplyPoll) || !replies.wait_for_matched(1, kReplyPoll)) {
    if (!connecting.is_over(support::monotonic_s())) continue;
    throw std::runtime_error(nothing_alive(peer.view, peer.what) + connecting.reason());
  }
  std::optional<Reply> reply;
  support::Patience patience(peer.wait_s, support::monotonic_s());
  double due_s = support::monotonic_s();
  while (!reply && !patience.is_over(support::monotonic_s())) {
    if (support::monotonic_s() >= due_s) {
      if (!requests.write(request)) throw std::runtime_error("the request could not be sent");
      due_s = support::monotonic_s() + kAgain_s;
    }
    if (!replies.wait_for_data(kReplyPoll)) continue;
    replies.take([&](const Reply& message, const messaging::SampleInfo& info) {
      if (info.valid && message.request_id() == request.request_id() &&
          message.client_id() == request.client_id()) {
        reply = message;
      }
    });
  }
  if (reply) return *reply;
  throw std::runtime_error(fmt::format("no {} of robot '{}' answered within {:.0f} ms{}", peer.what,
                                       peer.robot_id, 1000.0 * peer.wait_s, patience.reason()));
}

}  // namespace topogeo::cli
