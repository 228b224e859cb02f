#include "history/archive_requests.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/snapshot_pieces.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// Copying a large map takes a while.
constexpr double kArchivePatience_s = 20.0;
// Limits for sending a map file: at most 180 MB/s, and no more under way than the writer's history
// holds.
constexpr std::chrono::milliseconds kPiecePeriod{20};
constexpr std::uint32_t kPiecesAtOnce = 64;

Json snapshot_json(const msg::StoredSnapshot& snapshot) {
  Json json = {{"name", text_of_message(snapshot.name())},
               {"time_s", snapshot.time_s()},
               {"bytes", snapshot.bytes()}};
  if (const std::string damage = text_of_message(snapshot.damage()); !damage.empty()) {
    json["damage"] = damage;
    return json;
  }
  json["map_id"] = fmt::format("{:016x}", snapshot.map_id());
  json["version"] = std::to_string(snapshot.trajectory_version());
  json["stops"] = snapshot.stops();
  return json;
}

}  // namespace

ArchiveRequests::ArchiveRequests(service::Service& service)
    : service_(service),
      client_id_(support::process_name()),
      pending_(service, "no map store has answered", kArchivePatience_s),
      requests_(service.advertise<msg::ArchiveRequest>()),
      pieces_(service.advertise<msg::SnapshotPiece>()) {
  // Other readers of pieces may connect before that of the map store.
  service.loop().on_event([this](const messaging::Event& event) {
    if (event.kind == messaging::EventKind::kMatched && event.topic == messaging::kSnapshotPiece) {
      next_piece_ = 0;
    }
  });
  service.subscribe<msg::ArchiveReply>([this](const msg::ArchiveReply& reply) { on_reply(reply); },
                                       {.any_robot = true});
}

ArchiveRequests::~ArchiveRequests() {
  if (timer_) service_.loop().cancel_timer(*timer_);
}

void ArchiveRequests::list(Respond respond) {
  send(msg::kArchiveList, {}, [respond = std::move(respond)](Answer answer) {
    // A map store without snapshots is no fault of the question, which each page asks.
    constexpr int kRefused = 409;
    if (answer.status == kRefused) {
      answer = {200, text_of(Json{{"kept", false},
                                  {"message", Json::parse(answer.body).at("error")},
                                  {"snapshots", Json::array()}})};
    }
    respond(std::move(answer));
  });
}

void ArchiveRequests::take(const std::string& name, Respond respond) {
  storage::check_snapshot_name(name);
  send(msg::kArchiveTake, name, std::move(respond));
}

void ArchiveRequests::restore(const std::string& name, Respond respond) {
  storage::check_snapshot_name(name);
  send(msg::kArchiveRestore, name, std::move(respond));
}

void ArchiveRequests::remove(const std::string& name, Respond respond) {
  storage::check_snapshot_name(name);
  send(msg::kArchiveRemove, name, std::move(respond));
}

void ArchiveRequests::rename(const std::string& name, const std::string& new_name,
                             Respond respond) {
  storage::check_snapshot_name(name);
  storage::check_snapshot_name(new_name);
  constexpr std::size_t kMost = 63;  // the message has room for both names and a slash
  if (name.size() + new_name.size() > kMost) {
    throw std::invalid_argument("new_name: both names together have more than 63 characters");
  }
  send(msg::kArchiveRename, name + '/' + new_name, std::move(respond));
}

void ArchiveRequests::import(const std::string& name, std::string map_file, Respond respond) {
  if (timer_) {
    respond(error_answer(503, "another upload to the map store is in progress, try again later"));
    return;
  }
  storage::check_snapshot_name(name);
  map_file_ = std::move(map_file);
  next_piece_ = 0;
  timer_ = service_.loop().add_timer(kPiecePeriod, [this] { send_pieces(); });
  send(msg::kArchiveImport, name, [this, respond = std::move(respond)](Answer answer) {
    map_file_.clear();
    service_.loop().cancel_timer(*timer_);
    timer_.reset();
    respond(std::move(answer));
  });
}

void ArchiveRequests::send_pieces() {
  if (pieces_.matched() == 0) return;
  if (!pieces_.wait_for_acknowledgments({})) return;
  const std::uint32_t count = service::piece_count(map_file_.size());
  for (std::uint32_t i = 0; i < kPiecesAtOnce && next_piece_ < count; ++i) {
    msg::SnapshotPiece piece;
    messaging::set_header(piece, map_robot(), support::wall_clock_ns(), pieces_sent_);
    messaging::set_client_id(piece, service::kArchiveAddressee);
    piece.request_id(import_request_);
    service::cut_piece(piece, map_file_, next_piece_);
    if (!pieces_.write(piece)) return;
    ++pieces_sent_;
    ++next_piece_;
  }
}

const std::string& ArchiveRequests::map_robot() const {
  const std::string& other = service_.setup().options.map_robot;
  return other.empty() ? service_.robot_id() : other;
}

void ArchiveRequests::send(msg::ArchiveAction action, const std::string& name, Respond respond) {
  msg::ArchiveRequest request;
  messaging::set_header(request, map_robot(), support::wall_clock_ns(), sent_++);
  messaging::set_client_id(request, client_id_);
  request.action(action);
  messaging::set_text(request.name(), name, "name");
  pending_.begin(std::move(respond), [this, request](std::uint64_t id) mutable {
    if (request.action() == msg::kArchiveImport) import_request_ = id;
    request.request_id(id);
    static_cast<void>(requests_.write(request));
  });
}

void ArchiveRequests::on_reply(const msg::ArchiveReply& reply) {
  if (reply.client_id() != client_id_.c_str()) return;
  const std::optional<Respond> respond = pending_.take(reply.request_id());
  if (!respond) return;
  const std::string message = text_of_message(reply.message());
  if (!reply.accepted()) {
    (*respond)(error_answer(409, message));
    return;
  }
  Json snapshots = Json::array();
  for (const msg::StoredSnapshot& snapshot : reply.snapshots()) {
    snapshots.push_back(snapshot_json(snapshot));
  }
  (*respond)({200, text_of(Json{{"message", message}, {"snapshots", std::move(snapshots)}})});
}

}  // namespace topogeo::web
