// Reads the elements of a map database, of schema 1 to 3, as far as its rows can be read.
#include <array>
#include <map>
#include <sstream>
#include <utility>

#include "topogeo/exchange/repair.hpp"
#include "topogeo/storage/salvage.hpp"
#include "topogeo/support/format.hpp"

#include "map_fields.hpp"
#include "text.hpp"
#include "wire.hpp"

namespace topogeo::exchange {
namespace {

using storage::SalvagedRow;
using storage::SalvagedTable;

class DatabaseReader {
 public:
  explicit DatabaseReader(std::map<std::string, SalvagedTable> tables)
      : tables_(std::move(tables)) {}

  StoredPieces read() {
    for (const auto& [name, table] : tables_) {
      if ((name == "map_node" || name == "map_branch") &&
          (!table.complete || table.damaged_blobs > 0)) {
        pieces_.graph_incomplete = true;
      }
      if (!table.complete) {
        pieces_.damage.push_back(fmt::format("table {}: damaged pages, only {} rows are readable",
                                             name, table.rows.size()));
      }
      if (table.damaged_blobs > 0) {
        pieces_.damage.push_back(
            fmt::format("table {}: {} rows are damaged", name, table.damaged_blobs));
      }
    }
    read_meta();
    read_stops();
    pieces_.poses = blobs("stop_pose");
    pieces_.loops = blobs("loop_closure");
    pieces_.edges = blobs("edge");
    pieces_.nodes = blobs("map_node");
    pieces_.branches = blobs("map_branch");
    pieces_.places = blobs("place");
    pieces_.zones = blobs("zone");
    pieces_.rooms = blobs("room");
    pieces_.room_places = blobs("room_place");
    pieces_.lines = blobs("drawn_line");
    const std::vector<std::string> grids = blobs("drawn_grid");
    if (!grids.empty()) pieces_.grid = grids.back();
    return std::move(pieces_);
  }

 private:
  static std::string text_of(const SalvagedRow& row, const std::string& column) {
    const auto found = row.texts.find(column);
    return found == row.texts.end() ? std::string() : found->second;
  }
  static std::int64_t number_of_row(const SalvagedRow& row, const std::string& column) {
    const auto found = row.numbers.find(column);
    return found == row.numbers.end() ? -1 : found->second;
  }

  std::vector<std::string> blobs(const std::string& table) {
    // The ids restore the order of rows that were read back from the end.
    std::map<std::int64_t, std::string> ordered;
    for (const SalvagedRow& row : tables_[table].rows) {
      ordered[number_of_row(row, "row_number")] = text_of(row, "blob");
    }
    std::vector<std::string> out;
    out.reserve(ordered.size());
    for (auto& [id, blob] : ordered) out.push_back(std::move(blob));
    return out;
  }

  void read_meta() {
    std::map<std::string, std::string> values;
    for (const SalvagedRow& row : tables_["meta"].rows) {
      values[text_of(row, "key")] = text_of(row, "value");
    }
    const auto number = [&](const char* key) { return whole_number_of(values[key]).value_or(0); };
    pieces_.robot_id = values["robot_id"];
    pieces_.seed = number("seed");
    pieces_.map_id = number("map_id");
    pieces_.trajectory_version = number("trajectory_version");
    pieces_.map_version = number("global_map_version");
    pieces_.last_room = number("last_room");
    read_refused_merges(values["refused_merges"]);
  }

  void read_refused_merges(const std::string& text) {
    std::istringstream in(text);
    std::array<std::uint64_t, 2> session{};
    std::array<std::uint64_t, 2> number{};
    while (in >> std::hex >> session[0] >> std::dec >> number[0] >> std::hex >> session[1] >>
           std::dec >> number[1]) {
      pieces_.refused_merges.push_back(fixed64_field(MapFields::kSession, session[0]) +
                                       varint_field(MapFields::kNumber, number[0]) +
                                       fixed64_field(MapFields::kOtherSession, session[1]) +
                                       varint_field(MapFields::kOtherNumber, number[1]));
    }
    if (!in.eof()) pieces_.damage.emplace_back("the list of refused merges is damaged");
  }

  void read_stops() {
    std::map<std::uint32_t, StoredPieces::StoredStop> stops;
    for (const SalvagedRow& row : tables_["local_map"].rows) {  // schema 1
      add_stop(stops, number_of_row(row, "id"), text_of(row, "blob"), std::nullopt);
    }
    std::map<std::pair<std::int64_t, std::int64_t>, std::string> sent;
    for (const SalvagedRow& row : tables_["stop"].rows) {
      sent[{number_of_row(row, "session"), number_of_row(row, "number")}] = text_of(row, "blob");
    }
    for (const SalvagedRow& row : tables_["map_stop"].rows) {
      const auto at = sent.find({number_of_row(row, "session"), number_of_row(row, "number")});
      if (at == sent.end()) continue;
      add_stop(stops, number_of_row(row, "id"), at->second,
               number_of_row(row, "starts_drive") == 1);
    }
    for (auto& [id, stop] : stops) pieces_.stops.push_back(std::move(stop));
  }

  static void add_stop(std::map<std::uint32_t, StoredPieces::StoredStop>& stops, std::int64_t id,
                       std::string blob, std::optional<bool> starts_drive) {
    constexpr std::int64_t kMostStops = 10'000'000;  // a larger number is damaged
    if (id < 0 || id >= kMostStops) return;
    const auto number = static_cast<std::uint32_t>(id);
    stops[number] = {number, std::move(blob), starts_drive};
  }

  std::map<std::string, SalvagedTable> tables_;
  StoredPieces pieces_;
};

}  // namespace

StoredPieces pieces_of_database(const std::filesystem::path& path) {
  return DatabaseReader(storage::salvage_tables(path)).read();
}

}  // namespace topogeo::exchange
