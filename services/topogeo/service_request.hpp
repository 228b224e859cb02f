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
#include "topogeo/support/host.hpp"

#include "domain_view.hpp"

namespace topogeo::cli {

struct ServicePeer {
  const DomainView& view;
  const std::string& robot_id;
  double wait_s;
  std::string what = "localizer";  ///< for people
};

/// Sends `request`, which gets an id of its own, until the service has replied: its first reply
/// may go before it knows this reader. It carries out a request once and repeats the reply. Throws
/// std::runtime_error when nobody replies.
template <class Reply, class Request>
Reply ask(const ServicePeer& peer, Request request) {
  using std::chrono::milliseconds;
  using std::chrono::steady_clock;
  constexpr milliseconds kAgain{1000};
  messaging::set_client_id(request, support::process_name());
  request.request_id(std::random_device{}());
  const messaging::Participant participant = join(peer.view, "topogeo/" + peer.what);
  messaging::Writer<Request> requests(participant);
  messaging::Reader<Reply> replies(participant);
  const milliseconds patience(static_cast<milliseconds::rep>(1000.0 * peer.wait_s));
  if (!requests.wait_for_matched(1, patience) || !replies.wait_for_matched(1, patience)) {
    throw std::runtime_error(nothing_alive(peer.view, peer.what));
  }
  std::optional<Reply> reply;
  const steady_clock::time_point end = steady_clock::now() + patience;
  for (steady_clock::time_point due = {}; !reply && steady_clock::now() < end;) {
    if (steady_clock::now() >= due) {
      if (!requests.write(request)) throw std::runtime_error("the request could not be sent");
      due = steady_clock::now() + kAgain;
    }
    if (!replies.wait_for_data(milliseconds(100))) continue;
    replies.take([&](const Reply& message, const messaging::SampleInfo& info) {
      if (info.valid && message.request_id() == request.request_id() &&
          message.client_id() == request.client_id()) {
        reply = message;
      }
    });
  }
  if (reply) return *reply;
  throw std::runtime_error("no " + peer.what + " of robot '" + peer.robot_id +
                           "' answered within " + std::to_string(patience.count()) + " ms");
}

}  // namespace topogeo::cli
