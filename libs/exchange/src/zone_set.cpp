#include "topogeo/exchange/zone_set.hpp"

#include <algorithm>
#include <numbers>
#include <set>
#include <stdexcept>

#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "graph_checks.hpp"
#include "json_reader.hpp"
#include "segments.hpp"

namespace topogeo::exchange {
namespace {

using Json = nlohmann::ordered_json;
using planning::ZoneKind;

/// The same polygon from the same first corner, counter-clockwise.
std::vector<Eigen::Vector2d> counter_clockwise(std::vector<Eigen::Vector2d> corners) {
  if (signed_area2(corners) < 0.0) std::reverse(corners.begin() + 1, corners.end());
  return corners;
}

void add_fields(const planning::DrawnZone& zone, Json& out) {
  switch (zone.kind) {
    case ZoneKind::kNoGo:
      out["zoneType"] = "BLOCKED";
      break;
    case ZoneKind::kSlow:
      out["zoneType"] = "SPEED_LIMIT";
      out["maximumSpeed"] = zone.value;
      break;
    case ZoneKind::kOneWay:
      out["zoneType"] = "DIRECTED";
      out["direction"] = zone.value;
      // The text of VDA 5050 has the first name, the schema of 3.0.0 the second.
      out["directedLimitation"] = "RESTRICTED";
      out["limitation"] = "RESTRICTED";
      break;
    case ZoneKind::kPreferred:
      out["zoneType"] = "PRIORITY";
      out["priorityFactor"] = 1.0;
      break;
    case ZoneKind::kRoom:
      out["zoneType"] = "ACTION";
      for (const char* when : {"entryActions", "duringActions", "exitActions"}) {
        out[when] = Json::array();
      }
      break;
  }
}

void check_zones(std::span<const planning::DrawnZone> zones) {
  for (const planning::DrawnZone& zone : zones) {
    if (!is_simple(zone.polygon_m)) {
      throw std::invalid_argument(
          fmt::format("zone '{}': its border crosses or touches itself", zone.name));
    }
  }
  for (std::size_t i = 0; i < zones.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (zones[i].kind == ZoneKind::kOneWay && zones[j].kind == ZoneKind::kOneWay &&
          polygons_overlap(zones[i].polygon_m, zones[j].polygon_m)) {
        throw std::invalid_argument(
            fmt::format("zones '{}' and '{}': expected one-way zones that do not overlap",
                        zones[j].name, zones[i].name));
      }
    }
  }
}

class ZoneSetReader {
 public:
  ZoneSet read(const JsonValue& top) {
    // The message, or its content.
    const JsonValue set = top.at("zoneSet").exists() ? top.at("zoneSet") : top;
    for (const JsonValue& zone : set.required("zones").items()) add(zone);
    return std::move(set_);
  }

 private:
  void add(const JsonValue& in) {
    const std::string id = in.required("zoneId").text();
    const std::string type = in.required("zoneType").text();
    planning::DrawnZone zone;
    zone.name = in.at("zoneDescriptor").text_or(id);
    if (zone.name.size() > storage::kMaxNameBytes || !names_.insert(zone.name).second) {
      zone.name = id;
      names_.insert(id);
    }
    if (type == "BLOCKED") {
      zone.kind = ZoneKind::kNoGo;
    } else if (type == "SPEED_LIMIT") {
      zone.kind = ZoneKind::kSlow;
      zone.value =
          in.required("maximumSpeed")
              .number_between(planning::kLeastZoneSpeed_m_s, planning::kMostZoneSpeed_m_s, "m/s");
    } else if (type == "DIRECTED") {
      zone.kind = ZoneKind::kOneWay;
      zone.value =
          in.required("direction").number_between(-std::numbers::pi, std::numbers::pi, "rad");
    } else if (type == "PRIORITY") {
      zone.kind = ZoneKind::kPreferred;
      const double factor = in.required("priorityFactor").number_between(0.0, 1.0, "");
      if (factor != 1.0) {
        set_.notes.push_back(
            fmt::format("zone '{}': its priority {} counts as 1", zone.name, factor));
      }
    } else if (type != "ACTION") {
      set_.notes.push_back(
          fmt::format("zone '{}' left out: no zone kind corresponds to {}", zone.name, type));
      return;
    } else if (has_actions(in)) {
      set_.notes.push_back(fmt::format("zone '{}': its actions are left out", zone.name));
    }
    const JsonValue vertices = in.required("vertices");
    for (const JsonValue& vertex : vertices.items()) {
      zone.polygon_m.emplace_back(vertex.required("x").number(), vertex.required("y").number());
    }
    const std::string fault = settle_border(zone.polygon_m);
    if (!fault.empty()) vertices.fail(fault);
    set_.zones.push_back(std::move(zone));
  }

  static bool has_actions(const JsonValue& in) {
    return std::ranges::any_of(
        std::array{"entryActions", "duringActions", "exitActions"},
        [&](const char* when) { return in.at(when).exists() && !in.at(when).items().empty(); });
  }

  ZoneSet set_;
  std::set<std::string> names_;
};

}  // namespace

std::string zone_set_text(std::span<const planning::DrawnZone> zones, const ExportHeader& header) {
  check_zones(zones);
  Json list = Json::array();
  for (const planning::DrawnZone& zone : zones) {
    Json out = {{"zoneId", fmt::format("z{}", list.size() + 1)},
                {"zoneType", ""},
                {"zoneDescriptor", zone.name},
                {"vertices", Json::array()}};
    add_fields(zone, out);
    for (const Eigen::Vector2d& corner : counter_clockwise(zone.polygon_m)) {
      out["vertices"].push_back({{"x", corner.x()}, {"y", corner.y()}});
    }
    list.push_back(std::move(out));
  }
  const std::string map_id = plain_id(header.map_id);
  const std::uint64_t hash = support::fnv1a(map_id + list.dump());
  Json top = {{"headerId", 1},
              {"timestamp", utc_text(header.stamp_ns)},
              {"version", "3.0.0"},
              {"manufacturer", plain_id(header.manufacturer)},
              {"serialNumber", plain_id(header.robot_id)},
              {"zoneSet",
               {{"mapId", map_id},
                {"zoneSetId", fmt::format("{}-zones-{:016x}", map_id, hash)},
                {"zones", std::move(list)}}}};
  return top.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

ZoneSet parse_zone_set(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name);
  return ZoneSetReader().read(JsonValue(&json, name + ':'));
}

}  // namespace topogeo::exchange
