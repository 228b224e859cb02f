// The map of now joined with a map file that an operator offers: made, looked at, accepted or
// refused.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "topogeo/service/service.hpp"

#include "channels/drive_view.hpp"
#include "history/archive_requests.hpp"
#include "history/comparison.hpp"
#include "history/map_copies.hpp"
#include "orders/background.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class MapMerge {
 public:
  /// What the page gets of a comparison, with the address of its picture. Called in the loop.
  using Show = std::function<Json(Comparison comparison)>;

  /// All outlive it.
  MapMerge(service::Service& service, const DriveView& drive, MapCopies& copies,
           ArchiveRequests& archive, Background& background, Show show);

  /// The bytes of a map.pb. 200 with what the merge would change (docs/web_protocol.md); 400 where
  /// it is no map file; 409 where the maps do not join, or while another one is worked on. Nothing
  /// has changed yet.
  void offer(std::string map_file, const Respond& respond);
  /// {"number", "accept"}. Accepted the merged map takes the place of the map of now, of which a
  /// snapshot stays. Throws std::invalid_argument for another body.
  void answer(const std::string& body, const Respond& respond);

 private:
  struct Proposal {
    std::uint64_t number = 0;
    std::string map_file;
    std::uint64_t trajectory_version = 0;  ///< of the map that was merged
  };
  struct Result {
    Answer refusal;  ///< where nothing was merged
    std::string map_file;
    Comparison comparison;
    bool merged = false;
  };

  void merge(const MapCopies::Document& now, const std::shared_ptr<const std::string>& file,
             const Respond& respond);
  [[nodiscard]] static Result merged(const MapCopies::Document& now, const std::string& file,
                                     const pipeline::Config& config);

  service::Service& service_;
  const DriveView& drive_;
  MapCopies& copies_;
  ArchiveRequests& archive_;
  Background& background_;
  Show show_;
  bool busy_ = false;
  std::uint64_t offered_ = 0;
  std::optional<Proposal> proposal_;
};

}  // namespace topogeo::web
