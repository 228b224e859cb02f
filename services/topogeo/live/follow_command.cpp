// topogeo follow: the map of a robot as it changes.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/geojson.hpp"
#include "topogeo/exchange/graphml.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"

namespace topogeo::cli {
namespace {

/// Discovery takes a second.
constexpr std::chrono::seconds kWithoutStore{2};

struct FollowRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::filesystem::path out;
  bool once = false;
  bool json = false;
};

const char* kind_name(const msg::MapElement& element) {
  return element.kind() == msg::kElementNode ? "node" : "branch";
}

/// Names of msg::NodeKind in GraphML and GeoJSON.
std::string_view node_kind_name(const msg::MapElement& node) {
  return topomap::name_of(static_cast<topomap::NodeKind>(node.node_kind()));
}

std::string text_of(const map_client::Change& change) {
  const msg::MapElement& element = change.now ? *change.now : *change.before;
  const char* const sign = !change.before ? "+" : change.now ? "~" : "-";
  std::string line = fmt::format("{} {} {}", sign, kind_name(element), element.id());
  if (!change.now) return line;
  if (element.kind() == msg::kElementNode) {
    const msg::BranchPoint& at = element.node_position();
    return line + fmt::format(" {} at {:.3f} {:.3f}, clearance {:.3f} m, seen {} times",
                              node_kind_name(element), at.x_m(), at.y_m(), at.clearance_m(),
                              element.observations());
  }
  return line + fmt::format(" from {} to {}, {} points, seen {} times{}", element.node_a(),
                            element.node_b(), element.points().size(), element.observations(),
                            element.is_virtual() ? ", virtual" : "");
}

nlohmann::ordered_json json_point(const msg::BranchPoint& point) {
  return {point.x_m(), point.y_m(), point.clearance_m()};
}

nlohmann::ordered_json json_of(const map_client::Change& change) {
  const msg::MapElement& element = change.now ? *change.now : *change.before;
  nlohmann::ordered_json out;
  out["event"] = !change.before ? "added" : change.now ? "changed" : "removed";
  out["kind"] = kind_name(element);
  out["id"] = element.id();
  if (!change.now) return out;
  out["map_version"] = element.map_version();
  out["observations"] = element.observations();
  out["last_seen_ns"] = element.last_seen_ns();
  if (element.kind() == msg::kElementNode) {
    out["node_kind"] = node_kind_name(element);
    out["point"] = json_point(element.node_position());
  } else {
    out["node_a"] = element.node_a();
    out["node_b"] = element.node_b();
    out["is_virtual"] = element.is_virtual();
    out["points"] = nlohmann::ordered_json::array();
    for (const msg::BranchPoint& point : element.points())
      out["points"].push_back(json_point(point));
  }
  return out;
}

/// Last line of an update.
std::string summary_of(const map_client::Map& map, bool json) {
  if (!json) {
    return fmt::format("map {:016x} version {}: {} nodes, {} branches", map.map_id, map.version,
                       map.nodes.size(), map.branches.size());
  }
  nlohmann::ordered_json out;
  out["event"] = "map";
  out["map_id"] = map.map_id;
  out["map_version"] = map.version;
  out["stamp_ns"] = map.stamp_ns;
  out["nodes"] = map.nodes.size();
  out["branches"] = map.branches.size();
  return out.dump();
}

void write_map(const std::filesystem::path& out, const map_client::Map& map) {
  const topomap::GlobalMap graph = service::from_elements(map);
  if (out.extension() == ".graphml") {
    support::write_file_atomically(out, exchange::graphml_text(graph, {}));
  } else {
    const exchange::RouteNetwork network = exchange::route_network(graph, {}, nullptr, {});
    support::write_file_atomically(out, exchange::geojson_text(graph, {}, network));
  }
}

class Follower {
 public:
  explicit Follower(const FollowRequest& request)
      : request_(request),
        participant_(join_for(request.view, "topogeo/follow", request.robot_id, /*observe=*/true)),
        elements_(participant_),
        follower_(request.robot_id) {
    using messaging::SampleInfo;
    loop_.add<msg::MapElement>(
        elements_,
        [this](const msg::MapElement& element, const SampleInfo& info) {
          if (follower_.put(element, info.instance.bytes, info.writer.bytes)) show();
        },
        [this](const SampleInfo& info) {
          if (info.state != messaging::InstanceState::kDisposed) return;
          if (follower_.remove(info.instance.bytes, info.writer.bytes)) show();
        });
    loop_.add_timer(kWithoutStore, [this] { say_elsewhere(); });
    loop_.on_event([this](const messaging::Event& event) {
      if (event.kind == messaging::EventKind::kUnmatched && event.count == 0) say_waiting();
    });
  }

  /// Runs until a signal, or with --once until there is a map. Returns the exit code.
  int run() {
    const messaging::SignalStop signals([this](int) { loop_.stop(); });
    say_waiting();
    loop_.run();
    const int signal = messaging::SignalStop::received();
    return request_.once && !shown_ ? kSignalBase + signal : service::kOk;
  }

 private:
  void say_waiting() const {
    std::cerr << fmt::format(
        "topogeo: waiting for a map store of robot '{}' on domain {}, partition '{}'\n",
        request_.robot_id, request_.view.domain, request_.view.partition);
  }

  /// Once, when no map store is found.
  void say_elsewhere() {
    if (said_elsewhere_ || elements_.matched() > 0) return;
    said_elsewhere_ = true;
    std::cerr << "topogeo: "
              << nothing_alive(request_.view, "map store of robot '" + request_.robot_id + "'",
                               participant_.discovered())
              << '\n';
  }

  void show() {
    for (const map_client::Change& change : follower_.take_changes()) {
      std::cout << (request_.json ? json_of(change).dump() : text_of(change)) << '\n';
    }
    std::cout << summary_of(*follower_.map(), request_.json) << std::endl;
    if (!request_.out.empty()) write_map(request_.out, *follower_.map());
    shown_ = true;
    if (request_.once) loop_.stop();
  }

  FollowRequest request_;
  messaging::Participant participant_;
  messaging::Reader<msg::MapElement> elements_;
  messaging::EventLoop loop_;
  map_client::MapFollower follower_;
  bool shown_ = false;
  bool said_elsewhere_ = false;
};

void check_out(const std::filesystem::path& out) {
  const auto extension = out.extension();
  if (out.empty() || extension == ".graphml" || extension == ".geojson") return;
  throw service::UsageError("--out: '" + out.string() +
                            "', expected a name in .graphml or .geojson");
}

}  // namespace

void add_follow_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("follow", "Show the map of a robot and each change of it");
  auto request = std::make_shared<FollowRequest>();
  add_robot_option(*command, request->robot_id, "robot of the map");
  add_domain_options(*command, request->view);
  command->add_flag("--once", request->once, "show the current map and exit");
  command->add_flag("--json", request->json, "for programs: one JSON object on each line");
  command
      ->add_option(
          "--out", request->out,
          "also write the map to this file (.graphml or .geojson), like `topogeo store export`")
      ->type_name("FILE");
  command->footer(
      "Lines begin with + (new), ~ (changed) or - (gone); an update ends with the line of the "
      "map.\n"
      "Only complete maps are shown. Without a map store the last map remains.\n"
      "Ends with Ctrl-C, or with --once when there is a map. docs/follow_map.md: the same in C++.");
  command->callback([request, &exit_code] {
    check_out(request->out);
    exit_code = Follower(*request).run();
  });
}

}  // namespace topogeo::cli
