// Follows a map file from field to field, even if it is damaged.
#include <stdexcept>
#include <utility>

#include "topogeo/exchange/repair.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_fields.hpp"
#include "wire.hpp"

namespace topogeo::exchange {
namespace {

using Type = WireField::Type;

/// Type of a top-level field of a map file. Unknown fields are messages.
Type type_of(std::uint32_t number) {
  if (number == MapFields::kVersion || number == MapFields::kSeed) return Type::kVarint;
  if (number == MapFields::kMapId || number == MapFields::kChecksum) return Type::kFixed64;
  return Type::kBytes;
}

class MapFileReader {
 public:
  explicit MapFileReader(std::string_view bytes) : bytes_(bytes) {}

  StoredPieces read() {
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const std::size_t before = at;
      const auto field = next_field(at, last_);
      if (field) {
        take(*field);
        last_ = field->number;
        continue;
      }
      at = resume_after(before);
      gap_ = true;
      std::size_t next = at;
      const auto resumed = read_field(bytes_, next);
      if (!resumed || resumed->number >= MapFields::kGlobalMap) pieces_.graph_incomplete = true;
      pieces_.damage.push_back(fmt::format("bytes {} to {} cannot be read: {}", before, at - 1,
                                           at == bytes_.size()
                                               ? "the file is cut short or damaged to its end"
                                               : "their content is lost"));
    }
    return std::move(pieces_);
  }

 private:
  /// A field that may follow one of number `last`: files have them in ascending order.
  [[nodiscard]] std::optional<WireField> next_field(std::size_t& at, std::uint32_t last) const {
    std::size_t next = at;
    auto field = read_field(bytes_, next);
    if (!field || field->number < last || field->number > MapFields::kChecksum) return std::nullopt;
    if (field->type != type_of(field->number)) return std::nullopt;
    at = next;
    return field;
  }

  /// Where reading can continue: at the next local map of this robot, or where the rest up to the
  /// checksum is consistent.
  [[nodiscard]] std::size_t resume_after(std::size_t damaged) const {
    const std::string robot =
        pieces_.robot_id.empty() ? "" : bytes_field(MapFields::kRobotOfLocalMap, pieces_.robot_id);
    for (std::size_t start = damaged + 1; start < bytes_.size(); ++start) {
      std::size_t at = start;
      auto field = next_field(at, last_);
      if (!field) continue;
      if (field->number == MapFields::kLocalMap && !robot.empty() &&
          field->payload.starts_with(robot)) {
        return start;
      }
      std::uint32_t last = field->number;
      while (at < bytes_.size() && (field = next_field(at, last))) last = field->number;
      if (at == bytes_.size() && last == MapFields::kChecksum) return start;
    }
    return bytes_.size();
  }

  void take(const WireField& field) {
    const std::string payload(field.payload);
    switch (field.number) {
      case MapFields::kRobot:
        pieces_.robot_id = payload;
        break;
      case MapFields::kSeed:
        pieces_.seed = field.value;
        break;
      case MapFields::kMapId:
        pieces_.map_id = field.value;
        break;
      case MapFields::kLocalMap:
        take_local_map(payload);
        break;
      case MapFields::kTrajectory:
        take_parts(field.payload, pieces_.trajectory_version, {nullptr, nullptr, &pieces_.poses});
        break;
      case MapFields::kLoop:
        pieces_.loops.push_back(payload);
        break;
      case MapFields::kGlobalMap:
        if (!take_parts(field.payload, pieces_.map_version,
                        {nullptr, nullptr, &pieces_.nodes, &pieces_.branches})) {
          pieces_.graph_incomplete = true;
        }
        break;
      case MapFields::kDrawing:
        take_parts(field.payload, ignored_,
                   {nullptr, &pieces_.places, &pieces_.zones, &grids_, &pieces_.lines});
        if (!grids_.empty()) pieces_.grid = grids_.back();
        break;
      case MapFields::kEdge:
        pieces_.edges.push_back(payload);
        break;
      case MapFields::kRefusedMerge:
        pieces_.refused_merges.push_back(payload);
        break;
      case MapFields::kRooms:
        pieces_.last_room = number_in(payload, MapFields::kLastRoom).value_or(0);
        take_parts(field.payload, ignored_, {nullptr, &pieces_.rooms, &pieces_.room_places});
        break;
      default:
        break;
    }
  }

  void take_local_map(const std::string& payload) {
    const auto id = number_in(payload, MapFields::kIdOfLocalMap);
    // Numbers are consecutive; after lost bytes the number shows how many maps were lost with them.
    const std::uint32_t next = pieces_.stops.empty() ? 0 : pieces_.stops.back().id + 1;
    constexpr std::uint32_t kLongestGap = 10'000;  // a larger one is a damaged number
    const bool plausible =
        std::exchange(gap_, false) && id && *id >= next && *id - next < kLongestGap;
    pieces_.stops.push_back({plausible ? static_cast<std::uint32_t>(*id) : next, payload, {}});
  }

  /// The parts of a message, by their field numbers; field 1 is its version if no list is for it.
  /// False if the message ends early.
  bool take_parts(std::string_view message, std::uint64_t& version,
                  const std::vector<std::vector<std::string>*>& lists) {
    for (std::size_t at = 0; at < message.size();) {
      const auto field = read_field(message, at);
      if (!field) {
        pieces_.damage.emplace_back("a list of poses, nodes or drawn things ends early");
        return false;
      }
      if (field->type == Type::kVarint && field->number == 1) version = field->value;
      if (field->type == Type::kBytes && field->number < lists.size() &&
          lists[field->number] != nullptr) {
        lists[field->number]->emplace_back(field->payload);
      }
    }
    return true;
  }

  std::string_view bytes_;
  StoredPieces pieces_;
  std::uint32_t last_ = 0;  // number of the last field
  bool gap_ = false;        // bytes were lost since the last local map
  std::uint64_t ignored_ = 0;
  std::vector<std::string> grids_;
};

/// Checks all bytes except the last field, which is the checksum.
bool has_right_checksum(std::string_view bytes) {
  constexpr std::size_t kFieldBytes = 9;
  if (bytes.size() < kFieldBytes) return false;
  std::size_t at = bytes.size() - kFieldBytes;
  const std::uint64_t right = support::fnv1a(bytes.substr(0, at));
  const auto field = read_field(bytes, at);
  return field && field->number == MapFields::kChecksum && field->value == right;
}

}  // namespace

StoredPieces pieces_of_map_file(std::string_view bytes, const std::string& name) {
  constexpr std::string_view kFormat = "topogeo-map";
  // The first bytes may be damaged as well.
  if (bytes.substr(0, 64).find(kFormat) == std::string_view::npos) {
    throw std::runtime_error(name + ": not a topogeo map (no 'topogeo-map' at its beginning)");
  }
  StoredPieces pieces = MapFileReader(bytes).read();
  if (!has_right_checksum(bytes) && pieces.damage.empty()) {
    pieces.damage.emplace_back(
        "the checksum of the file is wrong: values that can be read may be damaged");
  }
  return pieces;
}

}  // namespace topogeo::exchange
