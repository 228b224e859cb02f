#include "map_store/snapshot_queue.hpp"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/messaging/message.hpp"

namespace topogeo::map_store {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::SizeIs;

class Snapshots : public testing::Test {
 protected:
  static msg::SnapshotRequest request(std::uint64_t id) {
    msg::SnapshotRequest out;
    messaging::set_header(out, "robot", 0, id);
    out.request_id(id);
    messaging::set_client_id(out, "client");
    return out;
  }
  bool work() { return queue_.work(now_, milliseconds(10000)); }

  SnapshotQueue::Clock::time_point now_ = SnapshotQueue::Clock::now();
  std::string answer_;
  std::string failure_;
  int made_ = 0;
  bool reader_takes_ = true;
  std::vector<msg::SnapshotPiece> sent_;
  SnapshotQueue queue_{"robot",
                       [this](const msg::SnapshotRequest&, const SnapshotQueue::Sink& sink) {
                         ++made_;
                         if (!failure_.empty()) throw std::runtime_error(failure_);
                         sink(std::string_view(answer_).substr(0, answer_.size() / 2));
                         sink(std::string_view(answer_).substr(answer_.size() / 2));
                       },
                       [this](const msg::SnapshotPiece& piece) {
                         if (reader_takes_) sent_.push_back(piece);
                         return reader_takes_;
                       }};
};

TEST_F(Snapshots, PiecesGiveTheWholeAnswer) {
  for (std::size_t i = 0; i < 2 * msg::kMaxPieceBytes + 1; ++i) {
    answer_ += static_cast<char>(i * i >> 3U);
  }
  queue_.add(request(7));
  EXPECT_TRUE(work());
  ASSERT_THAT(sent_, SizeIs(3));
  std::string got;
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sent_[i].request_id(), 7U);
    EXPECT_EQ(sent_[i].client_id().to_string(), "client");
    EXPECT_EQ(sent_[i].piece(), i);
    EXPECT_EQ(sent_[i].pieces(), 3U);
    got.append(sent_[i].bytes().begin(), sent_[i].bytes().end());
  }
  EXPECT_EQ(got, answer_);
  EXPECT_EQ(queue_.served(), 1U);
}

TEST_F(Snapshots, AnEmptyAnswerIsOnePiece) {
  queue_.add(request(1));
  EXPECT_TRUE(work());
  ASSERT_THAT(sent_, SizeIs(1));
  EXPECT_EQ(sent_[0].pieces(), 1U);
  EXPECT_THAT(sent_[0].bytes(), SizeIs(0));
}

TEST_F(Snapshots, AnAnswerThatCannotBeMadeSaysWhy) {
  failure_ = "map.sqlite: cut short " + std::string(400, '.');
  queue_.add(request(1));
  EXPECT_TRUE(work());
  ASSERT_THAT(sent_, SizeIs(1));
  EXPECT_EQ(sent_[0].pieces(), 0U);
  EXPECT_THAT(sent_[0].message().to_string(), HasSubstr("map.sqlite: cut short"));
  EXPECT_EQ(queue_.refused(), 1U);
}

TEST_F(Snapshots, ASlowReaderGetsEachPieceOnce) {
  answer_ = std::string(std::size_t{3} * msg::kMaxPieceBytes, 'x');
  queue_.add(request(1));
  reader_takes_ = false;
  EXPECT_FALSE(work());
  now_ += SnapshotQueue::kPatience / 2;
  EXPECT_FALSE(work());
  reader_takes_ = true;
  EXPECT_TRUE(work());
  ASSERT_THAT(sent_, SizeIs(3));
  EXPECT_EQ(sent_[2].piece(), 2U);
  EXPECT_EQ(made_, 1);
}

TEST_F(Snapshots, AReaderThatTakesNothingDoesNotHoldUpTheNext) {
  answer_ = "map";
  queue_.add(request(1));
  queue_.add(request(2));
  reader_takes_ = false;
  EXPECT_FALSE(work());
  now_ += SnapshotQueue::kPatience;
  EXPECT_FALSE(work()) << "the second one waits now";
  reader_takes_ = true;
  EXPECT_TRUE(work());
  ASSERT_THAT(sent_, SizeIs(1));
  EXPECT_EQ(sent_[0].request_id(), 2U);
  EXPECT_EQ(queue_.given_up(), 1U);
}

TEST_F(Snapshots, TheSameRequestTwiceIsAnsweredOnce) {
  queue_.add(request(1));
  queue_.add(request(1));
  EXPECT_TRUE(work());
  EXPECT_EQ(made_, 1);
}

TEST_F(Snapshots, TooManyRequestsAreRefused) {
  for (std::uint64_t id = 0; id < SnapshotQueue::kMostRequests + 5; ++id) queue_.add(request(id));
  EXPECT_TRUE(work());
  EXPECT_EQ(queue_.served(), SnapshotQueue::kMostRequests);
  EXPECT_EQ(queue_.refused(), 5U);
  EXPECT_THAT(sent_, SizeIs(SnapshotQueue::kMostRequests + 5));
}

}  // namespace
}  // namespace topogeo::map_store
