#include "map_output.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "topogeo/support/host.hpp"

#include "outputs.hpp"

namespace topogeo::ros_bridge {
namespace {

/// Tiles of an update arrive one by one.
constexpr std::chrono::milliseconds kMapPeriod{200};

}  // namespace

MapOutput::MapOutput(RosSide& ros) : ros_(ros) {
  const Settings& settings = ros.settings();
  service::Service& service = ros.service();
  if (settings.directions.map) {
    grids_ = ros.advertise<ros::OccupancyGrid>(settings.topics.map, settings.qos.map);
    updates_ =
        ros.advertise<ros::OccupancyGridUpdate>(settings.topics.map_updates, ros::Qos::kReliable);
  }
  if (settings.directions.graph) {
    graphs_ = ros.advertise<ros::MarkerArray>(settings.topics.graph, ros::Qos::kLatched);
    rooms_ = ros.advertise<ros::MarkerArray>(settings.topics.rooms, ros::Qos::kLatched);
    live_graph_.emplace(service);
  }
  using messaging::SampleInfo;
  service.subscribe<msg::GridTile>(
      [this](const msg::GridTile& tile, const SampleInfo& info) {
        mirror_.put(tile, info.instance);
      },
      {.of_map = true},
      [this](const SampleInfo& info) {
        if (info.state == messaging::InstanceState::kDisposed) mirror_.remove(info.instance);
      });
  service.subscribe<msg::HybridMap>([this](const msg::HybridMap& summary) { mirror_.put(summary); },
                                    {.of_map = true});
  service.status().set_counter("ros_maps_sent", 0.0);
  service.status().set_counter("map_updates_sent", 0.0);
  timer_ = service.loop().add_timer(kMapPeriod, [this] { tick(); });
}

MapOutput::~MapOutput() {
  ros_.service().loop().cancel_timer(timer_);
}

void MapOutput::tick() {
  publish_grid();
  if (live_graph_) publish_graph();
}

void MapOutput::publish_grid() {
  const std::string& frame = ros_.settings().frames.map;
  const auto change = mirror_.take();
  if (change && rooms_) ros_.send(*rooms_, room_markers(mirror_, frame, ros_.now_ns()));
  if (!grids_ || !mirror_.has_map()) return;
  if (change && !change->whole) {
    ros_.send(*updates_, mirror_.update(*change, frame, ros_.now_ns()));
    ros_.service().status().add_to_counter("map_updates_sent");
    whole_is_old_ = true;
  }
  const auto period_ns = std::llround(ros_.settings().map_period_s * 1e9);
  const bool due = whole_is_old_ && support::monotonic_ns() - whole_ns_ >= period_ns;
  // A new reader would get an outdated map, because earlier updates are not repeated for it.
  const bool newcomer = whole_is_old_ && grids_->matched() > readers_;
  readers_ = grids_->matched();
  if ((change && change->whole) || due || newcomer) publish_whole();
}

void MapOutput::publish_whole() {
  ros_.send(*grids_, mirror_.grid(ros_.settings().frames.map, ros_.now_ns()));
  ros_.service().status().add_to_counter("ros_maps_sent");
  whole_is_old_ = false;
  whole_ns_ = support::monotonic_ns();
}

void MapOutput::publish_graph() {
  try {
    const std::shared_ptr<const topomap::GlobalMap> graph = live_graph_->map();
    if (graph == graph_) return;
    graph_ = graph;
    ros_.send(*graphs_, graph_markers(*graph, ros_.settings().frames.map, ros_.now_ns()));
  } catch (const std::invalid_argument& error) {
    ros_.service().status().fault("invalid map", error.what());
  }
}

}  // namespace topogeo::ros_bridge
