#include "history/map_copies.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::web {
namespace {

constexpr std::chrono::seconds kCopiesTick{1};
constexpr double kCopyKept_s = 120.0;  // without use
constexpr std::size_t kMostCopies = 2;
constexpr double kFetchPatience_s = 60.0;

}  // namespace

MapCopies::MapCopies(service::Service& service, Background& background,
                     std::function<void()> on_shown)
    : service_(service),
      background_(background),
      store_(service, [on_shown = std::move(on_shown)](const msg::StoredMap& stored) {
        if (stored.session() == msg::kNothingIsStored) on_shown();
      }) {
  timer_ = service_.loop().add_timer(kCopiesTick, [this] { tick(); });
}

MapCopies::~MapCopies() {
  service_.loop().cancel_timer(timer_);
}

MapCopies::Document MapCopies::find(const std::string& snapshot, const Check& good) {
  for (Kept& kept : kept_) {
    if (kept.snapshot != snapshot || (snapshot.empty() && !good(*kept.map))) continue;
    kept.used_s = support::monotonic_s();
    return kept.map;
  }
  return nullptr;
}

void MapCopies::get(const std::string& snapshot, const Check& good, Handler handler) {
  if (const Document map = find(snapshot, good)) {
    handler(map, {});
  } else if (waiting_.size() >= kMostWaiting) {
    handler(nullptr, "too many map requests, try again later");
  } else {
    waiting_.push_back({snapshot, good, std::move(handler)});
    if (!fetching_) fetch_next();
  }
}

void MapCopies::fetch_next() {
  if (waiting_.empty()) return;
  fetching_ = true;
  fetching_since_s_ = support::monotonic_s();
  const std::string snapshot = waiting_.front().snapshot;
  store_.request(msg::kSnapshotMap, messaging::key_of(snapshot), 0,
                 [this, snapshot, fetch = ++fetch_](service::StoreClient::Answer answer) {
                   if (fetch != fetch_) return;  // this fetch was given up
                   if (answer.bytes) {
                     take(snapshot, std::move(*answer.bytes));
                   } else {
                     give(snapshot, nullptr, answer.why);
                   }
                 });
}

void MapCopies::take(const std::string& snapshot, std::string bytes) {
  const auto text = std::make_shared<const std::string>(std::move(bytes));
  const bool taken = background_.run([this, snapshot, text]() -> Background::Rest {
    try {
      const auto map = std::make_shared<const storage::MapDocument>(
          storage::parse_map_file(*text, "the map of the map store"));
      return [this, snapshot, map] { give(snapshot, map, {}); };
    } catch (const std::exception& error) {
      return [this, snapshot, why = std::string(error.what())] { give(snapshot, nullptr, why); };
    }
  });
  if (!taken) give(snapshot, nullptr, "too many requests in progress, try again later");
}

void MapCopies::give(const std::string& snapshot, const Document& map, const std::string& why) {
  fetching_ = false;
  if (map) {
    std::erase_if(kept_, [&](const Kept& kept) { return kept.snapshot == snapshot; });
    if (kept_.size() >= kMostCopies) {
      kept_.erase(std::ranges::min_element(kept_, {}, &Kept::used_s));
    }
    kept_.push_back({snapshot, map, support::monotonic_s()});
  }
  std::deque<Wanted> others;
  std::vector<Wanted> served;
  for (Wanted& wanted : waiting_) {
    if (wanted.snapshot == snapshot) {
      served.push_back(std::move(wanted));
    } else {
      others.push_back(std::move(wanted));
    }
  }
  waiting_ = std::move(others);
  for (const Wanted& wanted : served) wanted.handler(map, why);
  if (!fetching_) fetch_next();
}

void MapCopies::tick() {
  const double now_s = support::monotonic_s();
  std::erase_if(kept_, [&](const Kept& kept) { return now_s - kept.used_s > kCopyKept_s; });
  if (fetching_ && now_s - fetching_since_s_ > kFetchPatience_s) {
    ++fetch_;
    give(waiting_.front().snapshot, nullptr, "no map store has answered");
  }
}

}  // namespace topogeo::web
