#include "topogeo/recording/convert.hpp"

#include <stdexcept>
#include <utility>

#include "topogeo/recording/log_reader.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/ros_conversions/messages.hpp"

#include "message_sink.hpp"

namespace topogeo::recording {
namespace {

/// Just below the "no return" value of CARMEN logs, so that every measurement is kept, whatever the
/// limit of mapping.
constexpr double kRangeLimit_m = 81.9;

template <typename Message>
void translate(const RawMessage& message, Encoding from, Encoding to,
               std::vector<std::byte>& bytes) {
  const auto decoded =
      decode<Message>(message.data, from);  // checks the message even if the encoding is the same
  bytes.clear();
  if (from == to) {
    bytes.assign(message.data.begin(), message.data.end());
  } else {
    encode(decoded, to, bytes);
  }
}

/// Copies everything that both formats support, message by message.
class Copy {
 public:
  /// `name`: of the input file.
  Copy(std::string name, MessageSource& source, MessageSink& sink)
      : name_(std::move(name)), source_(source), sink_(sink) {}

  Conversion run() {
    RawMessage message;
    while (source_.next(message)) take(source_.topics()[message.topic], message);
    if (!source_.damage().empty()) done_.notes.push_back(source_.damage());
    sink_.close();
    if (done_.scans + done_.odometry + done_.transforms == 0) {
      throw std::runtime_error(name_ + ": expected laser scans, odometry or transforms, got none");
    }
    return std::move(done_);
  }

 private:
  void take(const Topic& topic, const RawMessage& message) {
    try {
      std::uint64_t* const count = translate_known(topic, message);
      if (count == nullptr) {
        ++done_.left_out[topic.name];
        return;
      }
      sink_.write({topic.name, type_, message.log_time_ns, bytes_});
      ++*count;
    } catch (const DecodeError& error) {
      if (++done_.left_out[topic.name] == 1) {
        done_.notes.push_back(source_.position() + " of " + topic.name + ": " + error.what());
      }
    }
  }

  /// The counter for the message; null for types that are not copied.
  std::uint64_t* translate_known(const Topic& topic, const RawMessage& message) {
    if (topic.encoding == Encoding::kOther) return nullptr;
    const Encoding to = sink_.encoding();
    if (topic.type == kLaserScanType) {
      translate<ros::LaserScan>(message, topic.encoding, to, bytes_);
      type_ = kLaserScanType;
      return &done_.scans;
    }
    if (topic.type == kOdometryType) {
      translate<ros::Odometry>(message, topic.encoding, to, bytes_);
      type_ = kOdometryType;
      return &done_.odometry;
    }
    if (topic.type == kTfType) {
      translate<ros::TFMessage>(message, topic.encoding, to, bytes_);
      type_ = kTfType;
      return &done_.transforms;
    }
    return nullptr;
  }

  std::string name_;
  MessageSource& source_;
  MessageSink& sink_;
  Conversion done_;
  std::vector<std::byte> bytes_;
  std::string_view type_;
};

/// Converts scan by scan, for a CARMEN log as input or output.
Conversion convert_scans(const std::filesystem::path& in, const std::filesystem::path& out,
                         const ConvertOptions& options) {
  LogMounting mounting = mounting_in_log(in, options.topics);
  LogReader reader(in, {.range_max_m = kRangeLimit_m, .detect_no_return = false}, options.topics);
  LogWriter writer(out, mounting.T_robot_laser.value_or(geometry::Pose2{}), options.compression);
  Conversion done;
  done.notes = std::move(mounting.notes);
  while (const std::optional<scan::Scan> scan = reader.next()) {
    writer.write(*scan);
    ++done.scans;
  }
  writer.close();
  done.odometry = done.scans;
  if (is_recording_name(out)) {
    done.transforms = done.scans + 1;
  }
  const scan::CarmenLogStatistics& statistics = reader.statistics();
  done.notes.insert(done.notes.end(), statistics.messages.begin(), statistics.messages.end());
  if (statistics.skipped_total() > 0) done.notes.push_back(statistics.summary());
  return done;
}

}  // namespace

Conversion convert(const std::filesystem::path& in, const std::filesystem::path& out,
                   const ConvertOptions& options) {
  std::error_code ignored;
  if (std::filesystem::equivalent(in, out, ignored)) {
    throw std::runtime_error(out.string() + ": expected a file other than the input");
  }
  if (!is_recording_name(out) || !is_recording(in)) return convert_scans(in, out, options);
  const std::unique_ptr<MessageSource> source =
      open_messages(in, [](const Topic& /*topic*/) { return true; });
  const std::unique_ptr<MessageSink> sink = create_sink(out, options.compression);
  return Copy(in.string(), *source, *sink).run();
}

}  // namespace topogeo::recording
