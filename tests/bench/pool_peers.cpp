#include "pool_peers.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <string_view>
#include <thread>
#include <utility>

#include <unistd.h>

#include "topogeo/service/conversions.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::bench {

using localization::MatchTask;
using localization::test::Maps;

namespace {

/// Ports of higher domains overlap with those that the system gives to clients.
constexpr std::uint32_t kDomains = 100;

std::filesystem::path this_program() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace

Maps maps_of_floor() {
  return localization::test::drive(localization::test::world("floor"), {}).maps;
}

TaskSource::TaskSource(Maps maps) : maps_(std::move(maps)) {
  for (const auto& map : maps_) hashes_.push_back(topomap::content_hash(*map));
}

std::vector<MatchTask> TaskSource::next(std::size_t count, std::uint64_t different) {
  constexpr std::size_t kBack = 3;
  std::vector<MatchTask> tasks(count);
  for (MatchTask& task : tasks) {
    task.task_id = made_++;
    task.seed = task.task_id % different;
    const std::size_t query = kBack + (task.seed / kBack) % (maps_.size() - kBack);
    const std::size_t reference = query - 1 - task.seed % kBack;
    task.reference_map_id = maps_[reference]->id;
    task.query_map_id = maps_[query]->id;
    task.reference_hash = hashes_[reference];
    task.query_hash = hashes_[query];
    task.T_reference_query =
        geometry::between(maps_[reference]->T_odom_robot, maps_[query]->T_odom_robot);
    // Assumed covariance of odometry after half a metre; searched: 95 % of it, two deviations.
    task.covariance = Eigen::Vector3d(0.01, 0.01, 0.0324).asDiagonal();
    task.half_width = localization::search_half_width(task.covariance, 0.95, 2.0);
  }
  return tasks;
}

std::uint32_t random_domain() {
  std::random_device device;
  return 1 + device() % kDomains;
}

PoolClient::PoolClient(const Maps& maps, bool verify, std::uint32_t domain) {
  std::random_device device;
  const std::string number = std::to_string(device());
  options_.domain = domain;
  options_.partition = "bench-" + number;
  options_.name = "bench";
  // When traffic is protected (TOPOGEO_SECURITY), no identity may write both tasks and local maps.
  options_.identity = "local_mapper";
  map_participant_.emplace(options_);
  map_writer_.emplace(*map_participant_);
  options_.identity = "localizer";
  participant_.emplace(options_);
  localizer::RemotePoolOptions pool;
  pool.robot_id = "robot";
  pool.client_id = "bench-" + number;
  pool.version = support::kVersion;
  pool.verify = verify;
  pool.log = [](const std::string& /*line*/) {};
  pool_.emplace(*participant_, loop_, pool, [this](std::string_view why, std::string_view detail) {
    fault_ = std::string(why) + ": " + std::string(detail);
  });
  for (const auto& map : maps) pool_->add_map(map);
}

std::vector<std::string> flags_of(std::uint32_t domain, const std::string& partition) {
  return {"--domain", std::to_string(domain), "--partition", partition};
}

std::vector<std::string> PoolClient::flags() const {
  return flags_of(options_.domain, options_.partition);
}

void PoolClient::publish(const Maps& maps) {
  for (const auto& map : maps) {
    if (!map_writer_->write(service::to_msg(*map))) fault_ = "local map not sent";
  }
}

double Workers::cpu_s(std::size_t worker) const {
  double sum_ns = 0.0;
  const std::filesystem::path tasks =
      "/proc/" + std::to_string(children_.at(worker).pid()) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks)) {
    double run_ns = 0.0;
    std::ifstream(task.path() / "schedstat") >> run_ns;
    sum_ns += run_ns;
  }
  return 1e-9 * sum_ns;
}

Workers::~Workers() {
  for (supervision::ChildProcess& child : children_) child.send_signal(SIGTERM);
  constexpr std::chrono::seconds kToLeave{5};
  constexpr std::chrono::milliseconds kLook{5};
  const Clock::time_point end = Clock::now() + kToLeave;
  for (supervision::ChildProcess& child : children_) {
    while (!child.poll() && Clock::now() < end)
      std::this_thread::sleep_for(kLook);  // between two checks
  }
}

void Workers::start_real(const PoolClient& client, std::vector<std::string> flags) {
  for (std::string& flag : client.flags()) flags.push_back(std::move(flag));
  children_.emplace_back("ga_worker", this_program().parent_path() / "ga_worker", flags,
                         "/dev/null");
}

void Workers::start_stubs(std::vector<std::string> words, std::size_t count,
                          std::chrono::microseconds cost) {
  words.insert(words.end(), {"--stub-workers", std::to_string(count), "--cost-us",
                             std::to_string(cost.count())});
  children_.emplace_back("stub workers", this_program(), words, "/dev/null");
}

}  // namespace topogeo::bench
