// What pages and programs see of a robot and may order: topics of DDS on one side, HTTP and
// WebSocket on the other.
//
// Handlers of topics turn messages into channels of the board, in the loop of the service; the
// server shows the board in threads of its own, and hands orders to the loop. Stop and driving by
// hand have a thread that nothing else uses.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
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
#include "orders/drawing_desk.hpp"
#include "orders/exploration_sender.hpp"
#include "orders/goal_sender.hpp"
#include "orders/hand_thread.hpp"
#include "orders/localizer_requests.hpp"
#include "server/board.hpp"
#include "server/page_files.hpp"
#include "server/server.hpp"
#include "server/tally.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service.
class WebService : private Backend {
 public:
  /// Listens from here on. Throws like Server.
  WebService(service::Service& service, const ServerConfig& config, PageFiles files);
  WebService(const WebService&) = delete;
  WebService& operator=(const WebService&) = delete;
  ~WebService() override;

  [[nodiscard]] std::uint32_t port() const { return server_->port(); }

 private:
  // In the threads of the server.
  void handle(const Request& request, Respond respond) override;
  void stop(Respond respond) override;
  void release_stop(Respond respond) override;
  void drive(std::uint64_t viewer, double linear_mps, double angular_radps) override;
  void release(std::uint64_t viewer) override;
  void hand_over(Request request, Respond respond);
  [[nodiscard]] Answer info(const Request& request) const;
  /// Calls it in the loop, unless this is gone by then.
  template <class Work>
  void post(Work work);

  // In the loop.
  void work_off_requests();
  void answer(const Request& request, const Respond& respond);
  void obey(const Request& request, const Respond& respond);
  [[nodiscard]] Answer give_goals(const std::string& body);
  [[nodiscard]] Answer preview(const std::string& body);
  [[nodiscard]] Answer go_back();
  void cancel();
  [[nodiscard]] ExploredFloor explored_floor();
  void load_floor(const std::string& body, const Respond& respond);
  [[nodiscard]] Answer room_shapes(const std::string& body);
  void report_counts();
  void show_limits(bool anew);
  [[nodiscard]] HandSender::Hooks hand_hooks();

  service::Service& service_;
  ServerConfig config_;
  PageFiles files_;
  Tally tally_;
  Board board_;
  FoxgloveFeed feed_;
  EventLog events_{board_};
  FoxgloveView foxglove_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // for what is posted
  HandThread hand_;
  MapView map_;
  GraphView graph_;
  GoalSender goals_;
  RobotView robot_;
  DriveView drive_;
  SearchView search_{service_, board_, drive_};
  ExplorationSender exploration_;
  HealthView health_;
  DrawingDesk drawing_;
  std::shared_ptr<const planning::HybridMap> limits_of_;
  std::shared_ptr<const navigation::DrawnLimits> limits_ =
      std::make_shared<const navigation::DrawnLimits>();
  std::uint64_t timer_ = 0;
  std::uint64_t limits_timer_ = 0;
  std::unique_ptr<Server> server_;
  // Below the server: an answer that is still to be given holds on to a connection.
  History history_{service_, drive_};
  LocalizerRequests localizer_;
  std::mutex mutex_;
  std::deque<std::pair<Request, Respond>> requests_;
};

}  // namespace topogeo::web
