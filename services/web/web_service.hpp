// Lets pages and programs observe and command a robot: DDS topics on one side, HTTP and WebSocket
// on the other.
//
// Topic handlers turn messages into channels of the hub, in the loop of the service; the server
// shows the hub in threads of its own and passes orders to the loop. Stop and driving by hand
// have a dedicated thread.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "topogeo/service/service.hpp"

#include "channels/drive_view.hpp"
#include "channels/event_log.hpp"
#include "channels/graph_view.hpp"
#include "channels/health_view.hpp"
#include "channels/map_view.hpp"
#include "channels/robot_view.hpp"
#include "channels/search_view.hpp"
#include "foxglove/foxglove_feed.hpp"
#include "foxglove/foxglove_view.hpp"
#include "history/history.hpp"
#include "kept_files.hpp"
#include "orders/audit_log.hpp"
#include "orders/drawing_editor.hpp"
#include "orders/exploration_sender.hpp"
#include "orders/goal_sender.hpp"
#include "orders/localizer_requests.hpp"
#include "orders/manual_drive_thread.hpp"
#include "routes.hpp"
#include "server/channel_hub.hpp"
#include "server/controls.hpp"
#include "server/page_files.hpp"
#include "server/request_queue.hpp"
#include "server/server.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class WebService : private Backend {
 public:
  /// Starts listening. Throws like Server, service::OperatorStop, AuditLog and AlarmFile.
  WebService(service::Service& service, const ServerConfig& config, PageFiles files,
             const KeptFiles& kept = {});
  WebService(const WebService&) = delete;
  WebService& operator=(const WebService&) = delete;
  ~WebService() override;

  [[nodiscard]] std::uint32_t port() const { return server_->port(); }

 private:
  /// Its handlers call the private functions and parts.
  friend std::span<const ServiceRoute> service_routes();

  // Called in the server's threads.
  [[nodiscard]] const Route* route(Method method, std::string_view path) const override;
  void handle(const Request& request, Respond respond) override;
  void stop(const std::string& page, Respond respond) override;
  void release_stop(const std::string& page, Respond respond) override;
  std::uint32_t enter(std::uint64_t viewer, const std::string& page,
                      const std::string& name) override;
  void leave(std::uint64_t viewer) override;
  [[nodiscard]] std::uint64_t stops() const override { return hand_.stops(); }
  void drive(std::uint64_t viewer, double linear_mps, double angular_radps) override;
  void release(std::uint64_t viewer) override;
  void hand_over(Request request, Respond respond);
  [[nodiscard]] Answer info(const Request& request) const;
  /// Calls `work` in the loop, unless this object is gone by then.
  template <class Work>
  void post(Work work);

  // Called in the loop.
  void work_off_requests();
  void answer(const Request& request, const Respond& respond);
  [[nodiscard]] Answer change_controls(const Request& request);
  /// Adds an order to the events, if it commands the robot, and to the audit log.
  void record(const Request& request, const Route& route);
  [[nodiscard]] Answer give_goals(const std::string& body);
  [[nodiscard]] Answer give(const GoalOrders& orders);
  [[nodiscard]] Answer preview(const std::string& body);
  [[nodiscard]] Answer go_back();
  void cancel();
  /// Like cancel(), but the goals can be resumed.
  void interrupt();
  [[nodiscard]] Answer resume();
  [[nodiscard]] ExploredFloor explored_floor();
  void load_floor(const std::string& body, const Respond& respond);
  [[nodiscard]] Answer room_shapes(const std::string& body);
  void report_counts();
  void show_limits(bool anew);
  [[nodiscard]] ManualDriveSender::Hooks hand_hooks();

  service::Service& service_;
  ServerConfig config_;
  PageFiles files_;
  Tally tally_;
  ChannelHub hub_;
  FoxgloveFeed feed_;
  EventLog events_;
  AuditLog audit_;
  FoxgloveView foxglove_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // for posted work
  Controls controls_;
  std::string stopper_;  // who has stopped the robot last
  std::int64_t stopped_ns_ = 0;
  ManualDriveThread hand_;
  MapView map_;
  GraphView graph_;
  GoalSender goals_;
  RobotView robot_;
  DriveView drive_;
  SearchView search_{service_, hub_, drive_};
  ExplorationSender exploration_;
  HealthView health_;
  DrawingEditor drawing_;
  std::shared_ptr<const planning::HybridMap> limits_of_;
  std::shared_ptr<const navigation::DrawnLimits> limits_ =
      std::make_shared<const navigation::DrawnLimits>();
  std::uint64_t timer_ = 0;
  std::uint64_t limits_timer_ = 0;
  std::unique_ptr<Server> server_;
  // Below the server, because a pending answer holds a connection.
  History history_{service_, drive_};
  LocalizerRequests localizer_;
  RequestQueue requests_;
};

}  // namespace topogeo::web
