#include "shared_pool.hpp"

#include <utility>
#include <vector>

namespace topogeo::localization {

class SharedPool::View : public MatchPool {
 public:
  explicit View(SharedPool& shared) : shared_(shared) {}

  void add_map(std::shared_ptr<const topomap::LocalMap> map) override {
    known_[map->id] = shared_.add(*map);
  }

  void add_field(std::shared_ptr<const PlaceField> field) override { field_ = std::move(field); }

  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    std::vector<MatchTask> renamed(tasks.begin(), tasks.end());
    for (MatchTask& task : renamed) {
      if (task.places) {
        if (shared_.field_ != field_) shared_.pool_.add_field(shared_.field_ = field_);
        task.task_id = shared_.next_task_++;
        const Known& query = known_.at(task.query_map_id);
        task.query_map_id = query.id;
        task.query_hash = query.hash;
        continue;
      }
      const Known& reference = known_.at(task.reference_map_id);
      const Known& query = known_.at(task.query_map_id);
      task.task_id = shared_.next_task_++;
      task.reference_map_id = reference.id;
      task.reference_hash = reference.hash;
      task.query_map_id = query.id;
      task.query_hash = query.hash;
    }
    std::vector<MatchResult> results = shared_.pool_.match(renamed);
    for (std::size_t i = 0; i < results.size(); ++i) results[i].task_id = tasks[i].task_id;
    return results;
  }

 private:
  SharedPool& shared_;
  std::shared_ptr<const PlaceField> field_;
  std::map<std::uint32_t, Known> known_;  // by the numbers of the map
};

std::unique_ptr<MatchPool> SharedPool::view() {
  return std::make_unique<View>(*this);
}

SharedPool::Known SharedPool::add(const topomap::LocalMap& map) {
  const auto found = known_.find(map.stop);
  if (found != known_.end()) return found->second;
  const auto id = static_cast<std::uint32_t>(known_.size());
  auto own = std::make_shared<const topomap::LocalMap>(topomap::numbered(map, id, false));
  const Known known{id, topomap::content_hash(*own)};
  pool_.add_map(std::move(own));
  known_[map.stop] = known;
  return known;
}

}  // namespace topogeo::localization
