#include "history/history.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "topogeo/exchange/map_export.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/support/host.hpp"

#include "channels/local_map_json.hpp"
#include "orders/order_text.hpp"
#include "resources.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// Name of exported files, without extension.
constexpr const char* kExportStem = "map";

Answer json_answer(const Json& json) {
  Answer answer;
  answer.body = text_of(json);
  return answer;
}

/// Path of an export: the name without extension if it has several files, otherwise the file.
std::string export_path(const exchange::MapFormat& format) {
  return format.endings.size() > 1 ? kExportStem
                                   : kExportStem + std::string(format.endings.front());
}

Answer exported_file(const storage::MapDocument& map, const exchange::MapFormat& format,
                     const std::string& file, const exchange::ExportSettings& settings) {
  const std::string path = export_path(format);
  for (exchange::OutputFile& made : exchange::export_map(map, format.name, path, settings).files) {
    if (made.path.filename() != file) continue;
    Answer answer;
    answer.body = std::move(made.bytes);
    answer.content_type = "application/octet-stream";
    return answer;
  }
  return error_answer(404, "this form has no such file");
}

std::string checked_name(const std::string& query, const char* key) {
  std::string name = query_value(query, key);
  if (!name.empty()) storage::check_snapshot_name(name);
  return name;
}

}  // namespace

History::History(service::Service& service, DriveView& drive)
    : service_(service), drive_(drive), archive_(service), background_(service.loop()) {
  copies_ = std::make_unique<MapCopies>(service, background_, [this] {
    if (drive_.trajectory_version() != 0) return;
    copies_->get(
        {}, [](const storage::MapDocument&) { return false; },
        [this](const MapCopies::Document& map, const std::string&) {
          if (map) drive_.show_stored(*map);
        });
  });
  merge_ = std::make_unique<MapMerge>(
      service, drive, *copies_, archive_, background_,
      [this](Comparison comparison) { return shown(std::move(comparison)); });
}

Json History::shown(Comparison comparison) {
  difference_png_ = std::move(comparison.png);
  comparison.json["picture"] = "/api/compare.png?v=" + std::to_string(++compared_);
  return std::move(comparison.json);
}

Answer History::formats() {
  Json formats = Json::array();
  for (const exchange::MapFormat& format : exchange::export_formats()) {
    Json files = Json::array();
    for (const std::string_view ending : format.endings) {
      files.push_back(kExportStem + std::string(ending));
    }
    formats.push_back({{"format", format.name}, {"files", std::move(files)}});
  }
  return json_answer({{"formats", std::move(formats)}});
}

void History::answer_later(Make make, const Respond& respond) {
  const bool taken =
      background_.run([make = std::move(make), respond]() mutable -> Background::Rest {
        try {
          respond(make());
        } catch (const std::exception& error) {
          respond(error_answer(409, error.what()));
        }
        return [] {};
      });
  if (!taken) respond(error_answer(503, "too many requests in progress, try again later"));
}

bool History::is_of_now(const storage::MapDocument& map) const {
  return map.trajectory.version >= drive_.trajectory_version();
}

void History::local_map(const std::string& query, const Respond& respond) {
  std::optional<topomap::StopId> stop;
  if (const std::string number = query_value(query, "stop"); !number.empty()) {
    stop = drive_.stop_at(parse_number(number, "stop"));
  } else {
    stop = topomap::StopId{
        parse_number(query_value(query, "session"), "session"),
        static_cast<std::uint32_t>(parse_number(query_value(query, "number"), "number"))};
  }
  if (!stop) return respond(error_answer(404, "there is no such stop"));
  if (const topomap::LocalMap* heard = drive_.heard(*stop)) {
    return respond(json_answer(local_map_json(*heard, drive_.pose_of(*stop))));
  }
  const auto find = [id = *stop](const storage::MapDocument& map) {
    return std::ranges::find(map.local_maps, id, &topomap::LocalMap::stop);
  };
  copies_->get(
      {}, [find](const storage::MapDocument& map) { return find(map) != map.local_maps.end(); },
      [this, find, id = *stop, respond](const MapCopies::Document& map, const std::string& why) {
        if (!map) return respond(error_answer(503, why));
        const auto found = find(*map);
        if (found == map->local_maps.end()) {
          return respond(error_answer(404, "the map store has no such stop"));
        }
        respond(json_answer(local_map_json(*found, drive_.pose_of(id))));
      });
}

void History::drive(const std::string& query, const Respond& respond) {
  const std::string text = query_value(query, "first");
  const std::size_t first = text.empty() ? 0 : parse_number(text, "first");
  // Later parts belong to the drive whose first part was requested, as long as that map is kept.
  const auto good = [this, first](const storage::MapDocument& map) {
    return first > 0 || is_of_now(map);
  };
  copies_->get(
      {}, good, [this, first, respond](const MapCopies::Document& map, const std::string& why) {
        if (!map) return respond(error_answer(503, why));
        answer_later([map, first] { return json_answer(drive_json(*map, first)); }, respond);
      });
}

void History::compare(const std::string& query, const Respond& respond) {
  const std::string before = checked_name(query, "before");
  const std::string after = checked_name(query, "after");
  if (before == after) throw std::invalid_argument("expected two versions, before and after");
  const auto good = [this](const storage::MapDocument& map) { return is_of_now(map); };
  const auto with_both = [this, before, after, respond](const MapCopies::Document& a,
                                                        const MapCopies::Document& b) {
    const auto& grid = service_.setup().config.config.hybrid_map.grid;
    const bool taken =
        background_.run([this, a, b, before, after, grid, respond]() -> Background::Rest {
          try {
            return [this, made = compared({before, a}, {after, b}, grid), respond]() mutable {
              respond(json_answer(shown(std::move(made))));
            };
          } catch (const std::exception& error) {
            return [respond, answer = error_answer(409, error.what())] { respond(answer); };
          }
        });
    if (!taken) respond(error_answer(503, "too many requests in progress, try again later"));
  };
  copies_->get(before, good,
               [this, after, good, with_both, respond](const MapCopies::Document& a,
                                                       const std::string& why) {
                 if (!a) return respond(error_answer(409, why));
                 copies_->get(after, good,
                              [a, with_both, respond](const MapCopies::Document& b,
                                                      const std::string& why_not) {
                                if (!b) return respond(error_answer(409, why_not));
                                with_both(a, b);
                              });
               });
}

void History::picture(const std::string& query, const Respond& respond) const {
  if (compared_ == 0 || query_value(query, "v") != std::to_string(compared_)) {
    return respond(error_answer(404, "another comparison was made in the meantime"));
  }
  Answer answer;
  answer.body = difference_png_;
  answer.content_type = "image/png";
  respond(answer);
}

void History::export_file(const std::string& path, const std::string& query,
                          const Respond& respond) {
  const std::size_t slash = path.find('/');
  const std::string name = path.substr(0, slash);
  const std::string file = slash == std::string::npos ? "" : path.substr(slash + 1);
  const auto formats = exchange::export_formats();
  const auto format = std::ranges::find(formats, name, &exchange::MapFormat::name);
  const bool known =
      format != formats.end() && std::ranges::any_of(format->endings, [&](std::string_view ending) {
        return file == kExportStem + std::string(ending);
      });
  if (!known) return respond(error_answer(404, "see /api/export for the files that there are"));
  exchange::ExportSettings settings;
  settings.hybrid_map = service_.setup().config.config.hybrid_map;
  settings.title = service_.robot_id();
  settings.odometry = query_value(query, "odometry") == "1";
  settings.loops = query_value(query, "loops") == "1";
  settings.header.stamp_ns = support::wall_clock_ns();
  copies_->get(
      {}, [this](const storage::MapDocument& map) { return is_of_now(map); },
      [this, format = *format, file, settings, respond](const MapCopies::Document& map,
                                                        const std::string& why) {
        if (!map) return respond(error_answer(503, why));
        answer_later(
            [map, format, file, settings] { return exported_file(*map, format, file, settings); },
            respond);
      });
}

void History::take_snapshot(const std::string& body, const Respond& respond) {
  archive_.take(parse_name(body), respond);
}

void History::restore(const std::string& body, const Respond& respond) {
  copies_->forget();
  archive_.restore(parse_name(body), respond);
}

// A kept copy is found by the name of its snapshot.
void History::remove_snapshot(const std::string& body, const Respond& respond) {
  copies_->forget();
  archive_.remove(parse_name(body), respond);
}

void History::rename_snapshot(const std::string& body, const Respond& respond) {
  copies_->forget();
  archive_.rename(parse_name(body), parse_name(body, "new_name"), respond);
}

}  // namespace topogeo::web
