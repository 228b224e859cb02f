#include "history/map_merge.hpp"

#include <array>
#include <ctime>
#include <exception>
#include <stdexcept>
#include <utility>

#include "topogeo/exchange/merge.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "orders/order_text.hpp"

namespace topogeo::web {
namespace {

/// Snapshot name for a merged map.
std::string merged_name() {
  const std::time_t now = std::time(nullptr);
  std::tm fields{};
  ::gmtime_r(&now, &fields);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "merged-%Y%m%d-%H%M%S", &fields)};
}

/// Why nothing was merged, in one sentence.
std::string why_apart(const exchange::MergedMap& made) {
  std::string why = "the maps do not join";
  for (const std::string& note : made.notes) why += ": " + note;
  return why;
}

void set_alignment(Json& json, const exchange::MergedMap& made) {
  json["joined"] = made.joined;
  json["left_out"] = made.left_out;
  json["confidence"] = rounded(made.alignment.confidence);
  json["sigma_m"] = rounded(made.alignment.sigma_m);
  json["agreeing"] = made.alignment.agreeing;
  json["searched"] = made.alignment.searched;
}

}  // namespace

MapMerge::MapMerge(service::Service& service, const DriveView& drive, MapCopies& copies,
                   ArchiveRequests& archive, Background& background, Show show)
    : service_(service),
      drive_(drive),
      copies_(copies),
      archive_(archive),
      background_(background),
      show_(std::move(show)) {}

void MapMerge::offer(std::string map_file, const Respond& respond) {
  if (busy_)
    return respond(error_answer(409, "another merge is in progress: try again when it is done"));
  busy_ = true;
  proposal_.reset();
  const auto file = std::make_shared<const std::string>(std::move(map_file));
  const auto done = [this, respond](Answer answer) {
    busy_ = false;
    respond(std::move(answer));
  };
  copies_.get(
      {},
      [this](const storage::MapDocument& map) {
        return map.trajectory.version >= drive_.trajectory_version();
      },
      [this, file, done](const MapCopies::Document& now, const std::string& why) {
        if (now) return merge(now, file, done);
        done(error_answer(503, why));
      });
}

void MapMerge::merge(const MapCopies::Document& now, const std::shared_ptr<const std::string>& file,
                     const Respond& respond) {
  const bool taken = background_.run([this, now, file, respond]() -> Background::Rest {
    const auto result =
        std::make_shared<Result>(merged(now, *file, service_.setup().config.config));
    return [this, now, result, respond] {
      if (!result->merged) return respond(result->refusal);
      proposal_ = Proposal{++offered_, std::move(result->map_file), now->trajectory.version};
      Json json = {{"number", offered_}};
      json.update(show_(std::move(result->comparison)));
      respond({200, text_of(json)});
    };
  });
  if (!taken) respond(error_answer(503, "too many requests in progress, try again later"));
}

MapMerge::Result MapMerge::merged(const MapCopies::Document& now, const std::string& file,
                                  const pipeline::Config& config) {
  Result result;
  storage::MapDocument other;
  try {
    other = storage::parse_map_file(file, "the file");
  } catch (const std::exception& error) {
    result.refusal = error_answer(400, error.what());
    return result;
  }
  try {
    exchange::MergedMap made = exchange::merge(*now, other, config);
    if (!made.merged) {
      result.refusal = error_answer(409, why_apart(made));
      return result;
    }
    result.map_file = storage::map_file_bytes(made.document);
    if (result.map_file.size() > kMostMapFile_bytes) {
      throw std::runtime_error(
          fmt::format("the merged map has {} MiB, at most {} can be sent: merge the files by "
                      "`topogeo store merge`",
                      result.map_file.size() >> 20U, kMostMapFile_bytes >> 20U));
    }
    const auto after = std::make_shared<const storage::MapDocument>(std::move(made.document));
    result.comparison = compared({"", now}, {"merged", after}, config.hybrid_map.grid);
    set_alignment(result.comparison.json, made);
    result.merged = true;
  } catch (const std::exception& error) {
    result.refusal = error_answer(409, error.what());
  }
  return result;
}

void MapMerge::answer(const std::string& body, const Respond& respond) {
  const MergeOrder order = parse_merge_order(body);
  if (!proposal_ || proposal_->number != order.number) {
    return respond(error_answer(409, "this merge is over: offer the map file again"));
  }
  Proposal proposal = *std::exchange(proposal_, std::nullopt);
  if (!order.accept) return respond({200, "{}"});
  if (drive_.trajectory_version() > proposal.trajectory_version) {
    return respond(error_answer(
        409, "the map has changed since: offer the map file again while the robot stands"));
  }
  const std::string name = merged_name();
  archive_.import(name, std::move(proposal.map_file), [this, name, respond](Answer answer) {
    if (answer.status != 200) return respond(std::move(answer));
    copies_.forget();
    archive_.restore(name, respond);
  });
}

}  // namespace topogeo::web
