#include "routes.hpp"

#include <algorithm>

#include "orders/order_text.hpp"
#include "resources.hpp"
#include "web_service.hpp"

namespace topogeo::web {
namespace {

constexpr std::string_view kTilesPath = "/tiles/";
constexpr std::string_view kExportPath = "/api/export/";

Answer accepted() {
  return {202, "{}"};
}

bool leads_to(const Route& route, std::string_view path) {
  return route.path.ends_with('/') ? path.starts_with(route.path) : path == route.path;
}

}  // namespace

std::span<const ServiceRoute> service_routes() {
  using enum Method;
  using enum Access;
  using enum Handling;
  using enum Offer;
  using enum AfterStop;
  using Web = WebService;
  // Method, path, access, limit of the body, handling, help; offer, after a stop, handler.
  static constexpr ServiceRoute kRoutes[] = {
      {{kGet, "/api/info", kAnybody, kNoBody_bytes, kAtOnce, "version, rights and orders"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(web.info(request));
       }},
      {{kGet, kTilesPath, kAnybody, kNoBody_bytes, kAtOnce, "pictures of the map"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(tile_answer(request, web.map_.shown().get()));
       }},
      {{kGet, "/api/at", kAnybody, kNoBody_bytes, kAtOnce, "what lies at a point"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(point_answer(request, web.map_.shown().get()));
       }},
      {{kGet, "/api/drawing", kAnybody, kNoBody_bytes, kAtOnce, "the drawing"},
       kNever,
       kObeyed,
       [](Web& web, const Request&, const Respond& respond) { respond(web.drawing_.shown()); }},
      {{kGet, "/api/local_map", kAnybody, kNoBody_bytes, kInLoop, "the local map of a stop"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.local_map(request.query, respond);
       }},
      {{kGet, "/api/drive", kAnybody, kNoBody_bytes, kInLoop, "the drive that made the map"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.drive(request.query, respond);
       }},
      {{kGet, "/api/snapshots", kAnybody, kNoBody_bytes, kInLoop, "the snapshots of the map"},
       kNever,
       kObeyed,
       [](Web& web, const Request&, const Respond& respond) { web.history_.list(respond); }},
      {{kGet, "/api/compare", kAnybody, kNoBody_bytes, kInLoop, "compares two versions"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.compare(request.query, respond);
       }},
      {{kGet, "/api/compare.png", kAnybody, kNoBody_bytes, kInLoop, "picture of a comparison"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.picture(request.query, respond);
       }},
      {{kGet, "/api/export", kAnybody, kNoBody_bytes, kInLoop, "the formats for export"},
       kNever,
       kObeyed,
       [](Web&, const Request&, const Respond& respond) { respond(History::formats()); }},
      {{kGet, kExportPath, kAnybody, kNoBody_bytes, kInLoop, "the map as a file"},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.export_file(request.path.substr(kExportPath.size()), request.query, respond);
       }},

      {{kPost, "/api/goal", kOperator, kMostBody_bytes, kInLoop, "sends the robot to goals", true},
       kAlways,
       kRefused,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(web.give_goals(request.body));
       }},
      {{kPost, "/api/preview", kOperator, kMostBody_bytes, kInLoop, "plans a route"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(web.preview(request.body));
       }},
      {{kPost, "/api/pause", kOperator, kMostBody_bytes, kInLoop, "pauses the drive", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         check_plain(request.body);
         web.goals_.pause();
         respond(accepted());
       }},
      {{kPost, "/api/resume", kOperator, kMostBody_bytes, kInLoop, "resumes the drive", true},
       kAlways,
       kRefused,
       [](Web& web, const Request& request, const Respond& respond) {
         check_plain(request.body);
         respond(web.resume());
       }},
      {{kPost, kCancelPath, kOperator, kMostBody_bytes, kInLoop, "cancels all goals", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         if (parse_keep(request.body)) {
           web.interrupt();
         } else {
           web.cancel();
         }
         respond(accepted());
       }},
      {{kPost, "/api/stop", kOperator, kMostBody_bytes, kStop, "stops and holds the robot"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.stop(request.page, respond);
       }},
      {{kPost, kReleasePath, kOperator, kMostBody_bytes, kRelease, "releases the robot", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.hand_.release_stop(request.stops, respond);
       }},
      {{kPost, "/api/return", kOperator, kMostBody_bytes, kInLoop, "sends the robot home", true},
       kAlways,
       kRefused,
       [](Web& web, const Request& request, const Respond& respond) {
         check_plain(request.body);
         respond(web.go_back());
       }},
      {{kPost, "/api/explore", kOperator, kMostBody_bytes, kInLoop, "starts an exploration", true},
       kAlways,
       kRefused,
       [](Web& web, const Request& request, const Respond& respond) {
         check_plain(request.body);
         respond(web.exploration_.start());
       }},
      {{kPost, "/api/pose", kOperator, kMostBody_bytes, kInLoop, "sets the position", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.localizer_.set_pose(parse_pose_order(request.body), respond);
       }},
      {{kPost, "/api/search", kOperator, kMostBody_bytes, kInLoop, "searches the whole map", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         check_plain(request.body);
         web.localizer_.search(respond);
       }},
      {{kPost, "/api/mode", kOperator, kMostBody_bytes, kInLoop, "switches mapping on or off",
        true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.localizer_.switch_mode(parse_mapping_mode(request.body), respond);
       }},
      {{kPost, "/api/merge", kOperator, kMostBody_bytes, kInLoop, "answers a proposed merge", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.localizer_.answer_merge(parse_merge_order(request.body), respond);
       }},
      {{kPost, "/api/snapshot", kOperator, kMostBody_bytes, kInLoop, "makes a snapshot"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.take_snapshot(request.body, respond);
       }},
      {{kPost, "/api/restore", kOperator, kMostBody_bytes, kInLoop, "restores a snapshot", true},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.restore(request.body, respond);
       }},
      {{kPost, "/api/snapshot_delete", kOperator, kMostBody_bytes, kInLoop, "deletes a snapshot"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.remove_snapshot(request.body, respond);
       }},
      {{kPost, "/api/snapshot_rename", kOperator, kMostBody_bytes, kInLoop, "renames a snapshot"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.rename_snapshot(request.body, respond);
       }},
      {{kPost, "/api/merge_map", kOperator, kMostMapFile_bytes, kInLoop, "aligns another map"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.offer_map(request.body, respond);
       }},
      {{kPost, "/api/merge_map_answer", kOperator, kMostBody_bytes, kInLoop, "joins the other map",
        true},
       kNever,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.history_.answer_merge(request.body, respond);
       }},
      {{kPost, "/api/drawing", kOperator, kMostDrawing_bytes, kInLoop, "replaces the drawing"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.drawing_.replace(request.body, respond);
       }},
      {{kPost, "/api/room_shapes", kAnybody, kMostBody_bytes, kInLoop, "outlines of zones"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(web.room_shapes(request.body));
       }},
      {{kPost, "/api/controls", kOperator, kMostBody_bytes, kInLoop,
        "asks for the controls, or takes them"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         respond(web.change_controls(request));
       }},
      {{kPost, "/api/alarms", kOperator, kMostBody_bytes, kInLoop, "acknowledges alarms"},
       kAlways,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.events_.acknowledge(parse_alarm_numbers(request.body),
                                 web.controls_.name_of(request.page));
         respond(accepted());
       }},
      {{kPost, "/api/floor", kOperator, kMostDrawing_bytes, kInLoop, "loads a drawn floor", true},
       kWithSimulator,
       kObeyed,
       [](Web& web, const Request& request, const Respond& respond) {
         web.load_floor(request.body, respond);
       }},
  };
  return kRoutes;
}

const ServiceRoute* find_route(Method method, std::string_view path) {
  const std::span<const ServiceRoute> routes = service_routes();
  const auto found = std::ranges::find_if(routes, [&](const ServiceRoute& row) {
    return row.route.method == method && leads_to(row.route, path);
  });
  return found == routes.end() ? nullptr : &*found;
}

}  // namespace topogeo::web
