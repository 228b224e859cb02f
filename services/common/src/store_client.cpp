#include "topogeo/service/store_client.hpp"

#include <random>
#include <string>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

namespace topogeo::service {

namespace {

constexpr std::chrono::milliseconds kAskPeriod{100};
constexpr std::chrono::milliseconds kSilence{1000};
/// Without another piece for so long, the store has gone or a piece is lost.
constexpr std::chrono::seconds kPatience{2};

}  // namespace

StoreClient::StoreClient(Service& service, std::function<void(const msg::StoredMap&)> on_stored)
    : service_(service),
      client_id_(fmt::format("{}-{:08x}", support::process_name(), std::random_device{}())),
      requests_(service.advertise<msg::SnapshotRequest>()) {
  service.subscribe<msg::StoredMap>(
      [on_stored = std::move(on_stored)](const msg::StoredMap& stored) {
        static_cast<void>(from_msg(stored.T_odom_robot()));  // throws
        on_stored(stored);
      },
      {.team = true});
  service.subscribe<msg::SnapshotPiece>(
      [this](const msg::SnapshotPiece& piece) { on_piece(piece); },
      {.addressee = client_id_, .any_robot = true});
  timer_ = service.loop().add_timer(kAskPeriod, [this] { tick(); });
}

StoreClient::~StoreClient() {
  service_.loop().cancel_timer(timer_);
}

void StoreClient::request(msg::SnapshotKind kind, std::uint64_t session, std::uint32_t first,
                          Handler handler) {
  msg::SnapshotRequest& request = request_.emplace();
  messaging::set_client_id(request, client_id_);
  request.kind(kind);
  request.session(session);
  request.first(first);
  handler_ = std::move(handler);
  send(true);
}

void StoreClient::send(bool anew) {
  messaging::set_header(*request_, service_.robot_id(), 0, requests_sent_++);
  if (anew) request_->request_id(requests_sent_);
  pieces_.clear();
  last_heard_ = Clock::now();
  // The timer repeats a request that cannot be sent now, or that the store cannot hear yet.
  heard_by_nobody_ = requests_.matched() == 0;
  static_cast<void>(requests_.write(*request_));
}

void StoreClient::on_piece(const msg::SnapshotPiece& piece) {
  if (!request_ || piece.request_id() != request_->request_id()) return;
  Answer answer;
  if (piece.pieces() > 0) {
    pieces_.add(piece);
    last_heard_ = Clock::now();
    if (!pieces_.complete()) return;
    answer.bytes = pieces_.take();
  } else {
    answer.why = piece.message().to_string();
  }
  request_.reset();
  pieces_.clear();
  std::exchange(handler_, {})(std::move(answer));
}

void StoreClient::tick() {
  if (!request_) return;
  const auto silence = Clock::now() - last_heard_;
  const bool first_reader = heard_by_nobody_ && requests_.matched() > 0;
  // A store still working on a long answer drops a repeated request. A new request would make it
  // start over, for ever if the answer takes longer than kPatience.
  if (first_reader || (pieces_.empty() && silence >= kSilence)) {
    send(false);
  } else if (silence >= kPatience) {
    send(true);
  }
}

}  // namespace topogeo::service
