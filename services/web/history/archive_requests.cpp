#include "history/archive_requests.hpp"

#include <optional>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// A large map takes its time to copy.
constexpr double kArchivePatience_s = 20.0;

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
      requests_(service.advertise<msg::ArchiveRequest>()) {
  service.subscribe<msg::ArchiveReply>([this](const msg::ArchiveReply& reply) { on_reply(reply); },
                                       {.any_robot = true});
}

void ArchiveRequests::list(Respond respond) {
  send(msg::kArchiveList, {}, std::move(respond));
}

void ArchiveRequests::take(const std::string& name, Respond respond) {
  storage::check_snapshot_name(name);
  send(msg::kArchiveTake, name, std::move(respond));
}

void ArchiveRequests::restore(const std::string& name, Respond respond) {
  storage::check_snapshot_name(name);
  send(msg::kArchiveRestore, name, std::move(respond));
}

void ArchiveRequests::send(msg::ArchiveAction action, const std::string& name, Respond respond) {
  const std::string& other = service_.setup().options.map_robot;
  msg::ArchiveRequest request;
  messaging::set_header(request, other.empty() ? service_.robot_id() : other,
                        support::wall_clock_ns(), sent_++);
  messaging::set_client_id(request, client_id_);
  request.action(action);
  messaging::set_text(request.name(), name, "name");
  pending_.begin(std::move(respond), [this, request](std::uint64_t id) mutable {
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
