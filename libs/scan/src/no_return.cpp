#include "topogeo/scan/no_return.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace topogeo::scan {
namespace {

constexpr double kBin_m = 0.001;
/// A farther reading is damaged.
constexpr float kDamaged_m = 1e6F;
/// A value of the window belongs to "no echo" if it has this share of the window's readings.
constexpr double kLeastOfWindow = 0.02;

struct Count {
  std::int64_t bin = 0;
  std::uint64_t readings = 0;
  std::uint32_t places = 0;
};

/// The counts of all bins, in order, with the sums of the readings before each.
class Histogram {
 public:
  explicit Histogram(std::vector<Count> counts) : counts_(std::move(counts)), before_(1, 0) {
    for (const Count& count : counts_) before_.push_back(before_.back() + count.readings);
  }

  [[nodiscard]] const std::vector<Count>& counts() const { return counts_; }
  /// Readings of the bins from `first` to `last`.
  [[nodiscard]] std::uint64_t between(std::int64_t first, std::int64_t last) const {
    return before_[place_after(last)] - before_[place_of(first)];
  }
  [[nodiscard]] std::uint64_t above(std::int64_t bin) const {
    return before_.back() - before_[place_after(bin)];
  }
  /// Number of the first count in or after a bin.
  [[nodiscard]] std::size_t place_of(std::int64_t bin) const {
    const auto found = std::ranges::lower_bound(counts_, bin, {}, &Count::bin);
    return static_cast<std::size_t>(found - counts_.begin());
  }

 private:
  [[nodiscard]] std::size_t place_after(std::int64_t bin) const { return place_of(bin + 1); }

  std::vector<Count> counts_;
  std::vector<std::uint64_t> before_;
};

/// Whether fewer than a third of the readings have changed. Drop-outs and NaN count as no change.
bool is_same_view(std::span<const float> before_m, std::span<const float> now_m) {
  if (before_m.size() != now_m.size()) return false;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < now_m.size(); ++i) {
    const bool both = before_m[i] > 0.0F && now_m[i] > 0.0F;
    if (both && std::fabs(now_m[i] - before_m[i]) > NoReturnFinder::kChanged_m) ++changed;
  }
  return 3 * changed < now_m.size();
}

constexpr std::int64_t kWindow = 20;  // bins
static_assert(kWindow * kBin_m < 1.001 * NoReturnFinder::kWindow_m &&
              kWindow * kBin_m > 0.999 * NoReturnFinder::kWindow_m);

/// The most readings of a window that ends below that of `bin`.
std::uint64_t most_below(const Histogram& histogram, std::int64_t bin) {
  const auto from = static_cast<std::int64_t>(NoReturnFinder::kCompared * static_cast<double>(bin));
  const std::size_t end = histogram.place_of(bin - kWindow);
  std::uint64_t most = 0;
  for (std::size_t i = histogram.place_of(from); i < end; ++i) {
    const std::int64_t last = histogram.counts()[i].bin;
    most = std::max(most, histogram.between(last - kWindow, last));
  }
  return most;
}

/// Whether the window that ends with `bin` has many more readings than there are above it, and than
/// any window below it has.
bool stands_out(const Histogram& histogram, std::int64_t bin) {
  const auto readings = static_cast<double>(histogram.between(bin - kWindow, bin));
  const auto exceeds = [&](std::uint64_t others) {
    return readings >= NoReturnFinder::kDominance * static_cast<double>(others);
  };
  return exceeds(histogram.above(bin + kWindow)) && exceeds(most_below(histogram, bin));
}

/// The values of the window that ends with `top`, without its few other readings.
NoReturn no_return_at(const Histogram& histogram, std::int64_t top, std::uint64_t readings) {
  const auto of_window = static_cast<double>(histogram.between(top - kWindow, top));
  std::int64_t lowest = top;
  Count most;
  for (std::size_t i = histogram.place_of(top - kWindow);
       i < histogram.counts().size() && histogram.counts()[i].bin <= top; ++i) {
    const Count& value = histogram.counts()[i];
    if (static_cast<double>(value.readings) >= kLeastOfWindow * of_window) {
      lowest = std::min(lowest, value.bin);
    }
    if (value.readings > most.readings) most = value;
  }
  const std::uint64_t without_echo = histogram.between(lowest, histogram.counts().back().bin);
  return {static_cast<double>(most.bin) * kBin_m, (static_cast<double>(lowest) - 0.5) * kBin_m,
          static_cast<double>(without_echo) / static_cast<double>(readings)};
}

}  // namespace

std::string text_of(const NoReturn& no_return) {
  char text[96];
  std::snprintf(text, sizeof(text), "a reading of %.3f m means no echo (%.1f %% of the readings)",
                no_return.range_m, 100.0 * no_return.share);
  return text;
}

void NoReturnFinder::add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot) {
  if (is_full()) return;
  if (T_odom_last_ &&
      geometry::between(*T_odom_last_, T_odom_robot).position_m().norm() < kPlace_m) {
    return;
  }
  T_odom_last_ = T_odom_robot;
  count(ranges_m);
}

void NoReturnFinder::add_without_odometry(std::span<const float> ranges_m) {
  if (is_full()) return;
  if (is_same_view(last_m_, ranges_m)) return;
  last_m_.assign(ranges_m.begin(), ranges_m.end());
  count(ranges_m);
}

void NoReturnFinder::count(std::span<const float> ranges_m) {
  ++places_;
  readings_ += ranges_m.size();
  for (const float range_m : ranges_m) {
    if (!(range_m > 0.0F) || !(range_m <= kDamaged_m)) continue;
    Bin& bin = bins_[std::llround(static_cast<double>(range_m) / kBin_m)];
    ++bin.readings;
    if (bin.last_place == places_) continue;
    bin.last_place = places_;
    ++bin.places;
  }
}

std::optional<NoReturn> NoReturnFinder::find() const {
  if (places_ < kLeastPlaces) return std::nullopt;
  std::vector<Count> counts;
  counts.reserve(bins_.size());
  for (const auto& [bin, count] : bins_) counts.push_back({bin, count.readings, count.places});
  const Histogram histogram(std::move(counts));
  const auto least =
      static_cast<std::uint64_t>(std::ceil(kLeastShare * static_cast<double>(readings_)));
  const std::vector<Count>& all = histogram.counts();
  const auto top = std::find_if(all.rbegin(), all.rend(), [&](const Count& count) {
    return count.readings >= least && count.places >= kLeastPlaces &&
           stands_out(histogram, count.bin);
  });
  if (top == all.rend()) return std::nullopt;
  return no_return_at(histogram, top->bin, readings_);
}

void NoReturnSearch::add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot) {
  by_odometry_.add(ranges_m, T_odom_robot);
  if (!has_moved()) by_views_.add_without_odometry(ranges_m);
}

std::optional<NoReturn> NoReturnSearch::find() const {
  return has_moved() ? by_odometry_.find() : by_views_.find();
}

bool NoReturnWatch::add(std::span<const float> ranges_m, const geometry::Pose2& T_odom_robot) {
  if (found_) return false;
  finder_.add(ranges_m, T_odom_robot);
  if (finder_.places() < next_search_) return false;
  next_search_ *= 2;
  found_ = finder_.find();
  return found_.has_value();
}

}  // namespace topogeo::scan
