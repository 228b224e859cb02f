// Answers requests about stored maps: local maps of stops, the drive to replay, snapshots,
// differences between two versions, and files for other programs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "topogeo/service/service.hpp"

#include "channels/drive_view.hpp"
#include "history/archive_requests.hpp"
#include "history/map_copies.hpp"
#include "history/map_merge.hpp"
#include "orders/background.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class History {
 public:
  /// `drive` must outlive it.
  History(service::Service& service, DriveView& drive);

  /// The formats in which the map can be exported.
  [[nodiscard]] static Answer formats();

  // All others answer once, at once or after the map store has answered. They throw
  // std::invalid_argument for a malformed query or body.

  void local_map(const std::string& query, const Respond& respond);
  void drive(const std::string& query, const Respond& respond);
  void list(const Respond& respond) { archive_.list(respond); }
  void compare(const std::string& query, const Respond& respond);
  /// The picture of the last comparison.
  void picture(const std::string& query, const Respond& respond) const;
  /// `path`: "{format}/{file}".
  void export_file(const std::string& path, const std::string& query, const Respond& respond);
  /// Body: {"name": "monday"}.
  void take_snapshot(const std::string& body, const Respond& respond);
  void restore(const std::string& body, const Respond& respond);
  void remove_snapshot(const std::string& body, const Respond& respond);
  void rename_snapshot(const std::string& body, const Respond& respond);
  /// See MapMerge.
  void offer_map(const std::string& map_file, const Respond& respond) {
    merge_->offer(map_file, respond);
  }
  void answer_merge(const std::string& body, const Respond& respond) {
    merge_->answer(body, respond);
  }

 private:
  /// Makes an answer from maps, in a background thread.
  using Make = std::function<Answer()>;

  /// JSON of a comparison for the page; its picture replaces the previous one.
  [[nodiscard]] Json shown(Comparison comparison);
  [[nodiscard]] bool is_of_now(const storage::MapDocument& map) const;
  /// Answers with the result of `make`; 409 when it throws std::exception.
  void answer_later(Make make, const Respond& respond);

  service::Service& service_;
  DriveView& drive_;
  ArchiveRequests archive_;
  // The picture of the last comparison, by its number.
  std::uint64_t compared_ = 0;
  std::string difference_png_;
  // Both are destroyed after the thread that works for them has ended.
  std::unique_ptr<MapCopies> copies_;
  std::unique_ptr<MapMerge> merge_;
  Background background_;
};

}  // namespace topogeo::web
