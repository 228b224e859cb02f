// Merges the current map with a map file offered by an operator, who reviews and then accepts or
// refuses the result.
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
  /// Returns the JSON of a comparison for the page, with the address of its picture. Called in the
  /// loop.
  using Show = std::function<Json(Comparison comparison)>;

  /// All references must outlive it.
  MapMerge(service::Service& service, const DriveView& drive, MapCopies& copies,
           ArchiveRequests& archive, Background& background, Show show);

  /// Takes the bytes of a map.pb. Answers 200 with the changes that the merge would make
  /// (docs/web_protocol.md); 400 for no map file; 409 when the maps do not join, or during another
  /// merge. The map itself does not change yet.
  void offer(std::string map_file, const Respond& respond);
  /// Body: {"number", "accept"}. An accepted map replaces the current one, which stays as a
  /// snapshot. Throws std::invalid_argument for another body.
  void answer(const std::string& body, const Respond& respond);

 private:
  struct Proposal {
    std::uint64_t number = 0;
    std::string map_file;
    std::uint64_t trajectory_version = 0;  ///< of the merged map
  };
  struct Result {
    Answer refusal;  ///< reason when nothing was merged
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
