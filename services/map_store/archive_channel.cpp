#include "archive_channel.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::map_store {

namespace {

msg::StoredSnapshot described(const storage::MapSnapshot& snapshot) {
  msg::StoredSnapshot out;
  messaging::set_text(out.name(), snapshot.name, "name");
  out.name_key(messaging::key_of(snapshot.name));
  out.time_s(snapshot.time_s);
  out.bytes(snapshot.bytes);
  out.map_id(snapshot.map_id);
  out.trajectory_version(snapshot.trajectory_version);
  out.stops(snapshot.stops);
  messaging::set_text_cut(out.damage(), snapshot.damage);
  return out;
}

/// In order of time; only the newest ones when there are more than a message holds. Files whose
/// names are invalid for snapshots are left out.
std::vector<msg::StoredSnapshot> described(const std::vector<storage::MapSnapshot>& snapshots) {
  std::vector<msg::StoredSnapshot> out;
  for (const storage::MapSnapshot& snapshot : snapshots) {
    try {
      storage::check_snapshot_name(snapshot.name);
    } catch (const std::invalid_argument&) {
      continue;
    }
    out.push_back(described(snapshot));
  }
  if (out.size() > msg::kMaxStoredSnapshots) {
    out.erase(out.begin(), out.end() - static_cast<std::ptrdiff_t>(msg::kMaxStoredSnapshots));
  }
  return out;
}

}  // namespace

ArchiveChannel::ArchiveChannel(service::Service& service, std::filesystem::path database,
                               Store store, Restore restore)
    : service_(service),
      database_(std::move(database)),
      store_(std::move(store)),
      restore_(std::move(restore)),
      replies_(service.advertise<msg::ArchiveReply>()) {
  service.subscribe<msg::ArchiveRequest>(
      [this](const msg::ArchiveRequest& request) { on_request(request); }, {.team = true});
  service.subscribe<msg::SnapshotPiece>(
      [this](const msg::SnapshotPiece& piece) { on_piece(piece); },
      {.addressee = service::kArchiveAddressee, .team = true});
}

void ArchiveChannel::on_piece(const msg::SnapshotPiece& piece) {
  if (piece.request_id() != import_request_) imported_.clear();
  import_request_ = piece.request_id();
  imported_.add(piece);
}

std::filesystem::path ArchiveChannel::path_of(std::uint64_t name_key) const {
  for (const storage::MapSnapshot& snapshot : storage::snapshots_of(database_)) {
    if (messaging::key_of(snapshot.name) == name_key) return snapshot.path;
  }
  throw std::runtime_error("no such snapshot");
}

void ArchiveChannel::on_request(const msg::ArchiveRequest& request) {
  if (last_ && last_->request_id() == request.request_id() &&
      last_->client_id() == request.client_id()) {
    static_cast<void>(replies_.write(*last_));
    return;
  }
  const bool here = import_request_ == request.request_id() && imported_.complete();
  if (request.action() == msg::kArchiveImport && !here) return;  // the client repeats the request
  msg::ArchiveReply& reply = last_.emplace();
  messaging::set_header(reply, service_.robot_id(), support::wall_clock_ns(), sent_++);
  messaging::set_text(reply.client_id(), request.client_id().to_string(), "client_id");
  reply.request_id(request.request_id());
  std::string message;
  try {
    if (database_.empty()) throw std::runtime_error("a map that is only shown has no snapshots");
    message = carry_out(request);
    reply.accepted(true);
  } catch (const std::exception& error) {
    message = error.what();
  }
  messaging::set_text_cut(reply.message(), message);
  if (!database_.empty()) reply.snapshots() = described(storage::snapshots_of(database_));
  static_cast<void>(replies_.write(reply));
  if (reply.accepted() && request.action() == msg::kArchiveRestore) {
    // Lets the client get the reply before its writer goes.
    constexpr std::chrono::milliseconds kReplyPatience{500};
    static_cast<void>(replies_.wait_for_acknowledgments(kReplyPatience));
    restore_(request.name().to_string());
  }
}

std::string ArchiveChannel::carry_out(const msg::ArchiveRequest& request) {
  const std::string name = request.name().to_string();
  switch (request.action()) {
    case msg::kArchiveList:
      return {};
    case msg::kArchiveTake: {
      store_();
      const storage::MapSnapshot taken = storage::take_snapshot(database_, name);
      spdlog::info("stored snapshot {}", taken.path.string());
      return fmt::format("snapshot {} has {} stops", name, taken.stops);
    }
    case msg::kArchiveImport: {
      const storage::MapSnapshot made = storage::import_snapshot(
          database_, name, storage::parse_map_file(imported_.take(), "the uploaded map"));
      spdlog::info("stored the uploaded map as snapshot {}", made.path.string());
      return fmt::format("snapshot {} has {} stops", name, made.stops);
    }
    case msg::kArchiveRestore: {
      storage::check_snapshot_name(name);
      const auto known = storage::snapshots_of(database_);
      const auto found = std::ranges::find(known, name, &storage::MapSnapshot::name);
      if (found == known.end()) throw std::runtime_error("there is no snapshot " + name);
      if (!found->damage.empty()) throw std::runtime_error(found->damage);
      return fmt::format("restoring snapshot {}; the current map is kept as snapshot before-{}",
                         name, name);
    }
    case msg::kArchiveRemove:
      storage::remove_snapshot(database_, name);
      spdlog::info("deleted snapshot {}", name);
      return fmt::format("snapshot {} is deleted", name);
    case msg::kArchiveRename: {
      const std::size_t slash = name.find('/');
      if (slash == std::string::npos) throw std::runtime_error("expected two names");
      const std::string new_name = name.substr(slash + 1);
      storage::rename_snapshot(database_, name.substr(0, slash), new_name);
      spdlog::info("renamed snapshot {}", name);
      return fmt::format("the snapshot is now {}", new_name);
    }
    default:
      throw std::runtime_error("unknown action");
  }
}

}  // namespace topogeo::map_store
