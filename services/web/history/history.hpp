// What pages ask of stored maps: local maps of stops, the drive to play, snapshots, what differs
// between two versions, and files for other programs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

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
  /// `drive` outlives it.
  History(service::Service& service, DriveView& drive);

  /// Whether get() answers this path. For any thread.
  [[nodiscard]] static bool has(std::string_view path);
  /// Answers once, soon or when the map store has answered. Throws std::invalid_argument for a
  /// request that cannot be understood.
  void get(const Request& request, const Respond& respond);

  /// {"name": "monday"}. Both throw std::invalid_argument as get() does.
  void take_snapshot(const std::string& body, const Respond& respond);
  void restore(const std::string& body, const Respond& respond);
  /// See MapMerge.
  void offer_map(const std::string& map_file, const Respond& respond) {
    merge_->offer(map_file, respond);
  }
  void answer_merge(const std::string& body, const Respond& respond) {
    merge_->answer(body, respond);
  }

 private:
  /// Makes an answer of maps, in a thread.
  using Make = std::function<Answer()>;

  void local_map(const std::string& query, const Respond& respond);
  void drive(const std::string& query, const Respond& respond);
  void compare(const std::string& query, const Respond& respond);
  void picture(const std::string& query, const Respond& respond) const;
  void export_file(const std::string& path, const Respond& respond);
  /// What the page gets of a comparison; its picture replaces the one before.
  [[nodiscard]] Json shown(Comparison comparison);
  [[nodiscard]] bool is_of_now(const storage::MapDocument& map) const;
  /// Answers with what `make` returns; 409 where it throws std::exception.
  void answer_later(Make make, const Respond& respond);

  service::Service& service_;
  DriveView& drive_;
  ArchiveRequests archive_;
  // The picture of the comparison that was made last, by its number.
  std::uint64_t compared_ = 0;
  std::string difference_png_;
  // Both go after the thread that works for them has ended.
  std::unique_ptr<MapCopies> copies_;
  std::unique_ptr<MapMerge> merge_;
  Background background_;
};

}  // namespace topogeo::web
