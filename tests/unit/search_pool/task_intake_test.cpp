// Tasks that wait for local maps.
#include "topogeo/search_pool/task_intake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "worker_fixture.hpp"

namespace topogeo::search_pool {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class TaskIntakeTest : public ::testing::Test {
 protected:
  static TaskIntake::Time at(int ms) { return TaskIntake::Time{} + milliseconds(ms); }

  static MapPointer stamped(std::int64_t stamp_ns, const MapPointer& map) {
    topomap::LocalMap copy = *map;
    copy.stamp_ns = stamp_ns;
    return std::make_shared<const topomap::LocalMap>(std::move(copy));
  }

  MapPointer zero_ = room(0, 0.0);
  MapPointer one_ = room(1, 0.2);
  MapPointer two_ = room(2, 0.4);
  TaskIntake intake_;
};

TEST_F(TaskIntakeTest, AJobWhoseMapsAreThereIsReadyAtOnce) {
  intake_.add_map(zero_);
  intake_.add_map(one_);
  const auto ready = intake_.add(job(zero_, one_, 5), at(0));
  ASSERT_TRUE(ready);
  EXPECT_EQ(ready->job.ticket, 5U);
  EXPECT_EQ(ready->reference, zero_);
  EXPECT_EQ(ready->query, one_);
  EXPECT_FALSE(intake_.next_check());
}

TEST_F(TaskIntakeTest, AJobWaitsForItsMapsAndOthersPassIt) {
  intake_.add_map(zero_);
  intake_.add_map(one_);
  EXPECT_FALSE(intake_.add(job(zero_, two_, 1), at(0)));
  EXPECT_FALSE(intake_.add(job(two_, one_, 2), at(0)));
  EXPECT_TRUE(intake_.add(job(zero_, one_, 3), at(0)));
  EXPECT_EQ(intake_.waiting(), 2U);
  const auto ready = intake_.add_map(two_);
  ASSERT_THAT(ready, SizeIs(2));
  EXPECT_EQ(ready[0].job.ticket, 1U);
  EXPECT_EQ(ready[0].query, two_);
  EXPECT_EQ(ready[1].reference, two_);
  EXPECT_EQ(intake_.waiting(), 0U);
  EXPECT_FALSE(intake_.next_check());
}

TEST_F(TaskIntakeTest, AMapOfOtherContentIsNotTheOneThatIsMeant) {
  intake_.add_map(zero_);
  intake_.add_map(room(1, 0.3));
  EXPECT_FALSE(intake_.add(job(zero_, one_, 1), at(0)));
  EXPECT_TRUE(intake_.lacks(topomap::content_hash(*one_)));
  EXPECT_FALSE(intake_.lacks(topomap::content_hash(*zero_)));
  EXPECT_THAT(intake_.add_map(room(1, 0.1)), IsEmpty());
  EXPECT_THAT(intake_.add_map(one_), SizeIs(1));
  EXPECT_FALSE(intake_.lacks(topomap::content_hash(*one_)));
}

TEST_F(TaskIntakeTest, AMapThatMayBeOnItsWayIsAskedForAfterAShortWaitAndAgain) {
  intake_.add_map(zero_);
  intake_.add(job(zero_, one_, 1), at(0));
  intake_.add(job(one_, zero_, 2), at(5));
  EXPECT_EQ(intake_.next_check(), at(20));
  EXPECT_THAT(intake_.check(at(19)).requests, IsEmpty());
  const TaskIntake::Due due = intake_.check(at(20));
  ASSERT_THAT(due.requests, SizeIs(1)) << "one for both";
  EXPECT_EQ(due.requests[0].client_id, "client");
  EXPECT_EQ(due.requests[0].robot_id, "robot");
  EXPECT_EQ(due.requests[0].map_id, 1U);
  EXPECT_EQ(due.requests[0].content_hash, topomap::content_hash(*one_));
  EXPECT_EQ(intake_.next_check(), at(520));
  EXPECT_THAT(intake_.check(at(519)).requests, IsEmpty());
  EXPECT_THAT(intake_.check(at(520)).requests, SizeIs(1));
}

TEST_F(TaskIntakeTest, AMapThatIsNotTheNewestIsAskedForAtOnce) {
  intake_.add_map(one_);
  intake_.add(job(zero_, one_, 1), at(0));
  EXPECT_EQ(intake_.next_check(), at(0));
  EXPECT_THAT(intake_.check(at(0)).requests, SizeIs(1));
  EXPECT_EQ(intake_.next_check(), at(500));
  intake_.add(job(zero_, one_, 9), at(1));
  EXPECT_EQ(intake_.next_check(), at(500)) << "it was asked for";
  // A map that is new for one task is old for another.
  intake_.add(job(one_, two_, 2), at(100));
  EXPECT_THAT(intake_.check(at(100)).requests, IsEmpty());
  intake_.add(job(two_, room(3, 0.6), 3), at(110));
  EXPECT_THAT(intake_.check(at(110)).requests, SizeIs(1));
}

TEST_F(TaskIntakeTest, TheNewestMapIsAskedForAtOnceWhenItsTimeHasPassed) {
  intake_.add_map(zero_);
  MatchJob task = job(zero_, one_, 1);
  task.stamp_ns = 1000;
  intake_.add_published(stamped(2000, room(3, 0.6, "other robot")));
  intake_.add_published(stamped(999, room(3, 0.6)));
  intake_.add(task, at(0));
  EXPECT_EQ(intake_.next_check(), at(20)) << "it may be on its way";
  intake_.add_published(stamped(1000, room(4, 0.7)));
  intake_.add(task, at(5));
  EXPECT_EQ(intake_.next_check(), at(5)) << "it came, and is not the one that is meant";
}

TEST_F(TaskIntakeTest, TimeMayBeginAnew) {
  intake_.add_map(zero_);
  intake_.add_published(stamped(2000, room(3, 0.6)));
  intake_.add_published(stamped(500, room(4, 0.7)));
  MatchJob task = job(zero_, one_, 1);
  task.stamp_ns = 1000;
  intake_.add(task, at(0));
  EXPECT_EQ(intake_.next_check(), at(20)) << "it may be on its way";
}

// A localizer that follows a stored map does so.
TEST_F(TaskIntakeTest, FindsWhatWasPublishedWithAnotherNumber) {
  intake_.add_map(zero_);
  EXPECT_FALSE(intake_.add(job(zero_, one_, 1), at(0)));
  EXPECT_THAT(intake_.add_published(room(70, 0.2, "other robot")), IsEmpty());
  EXPECT_THAT(intake_.add_published(room(71, 0.3)), IsEmpty());
  const auto ready = intake_.add_published(room(72, 0.2));
  ASSERT_THAT(ready, SizeIs(1));
  EXPECT_EQ(ready[0].reference, zero_);
  EXPECT_EQ(topomap::content_hash(*ready[0].query), topomap::content_hash(*one_));
  EXPECT_FALSE(intake_.next_check());
  // The task may arrive after the map, with any number for it.
  EXPECT_TRUE(intake_.add(job(zero_, one_, 2), at(1)));
  EXPECT_TRUE(intake_.add(job(room(9, 0.3), one_, 3), at(1)));
  EXPECT_EQ(intake_.waiting(), 0U);
}

TEST_F(TaskIntakeTest, RemembersOnlyTheNewestMapsThatWerePublished) {
  intake_.add_map(zero_);
  intake_.add_published(room(70, 0.2));
  for (std::uint32_t i = 1; i < 4; ++i) intake_.add_published(room(70 + i, 0.2 + 0.01 * i));
  EXPECT_TRUE(intake_.add(job(zero_, one_, 1), at(0)));
  intake_.add_published(room(74, 0.5));
  EXPECT_FALSE(intake_.add(job(zero_, room(8, 0.2), 2), at(0)));
}

TEST_F(TaskIntakeTest, EachClientIsAskedForWhatItsOwnTaskNames) {
  intake_.add(job(zero_, one_, 1, "a"), at(0));
  intake_.add(job(zero_, one_, 2, "b"), at(100));
  EXPECT_THAT(intake_.check(at(50)).requests, SizeIs(2)) << "two maps of a";
  EXPECT_THAT(intake_.check(at(150)).requests, SizeIs(2)) << "two maps of b";
  EXPECT_THAT(intake_.add_map(zero_), IsEmpty());
  EXPECT_THAT(intake_.check(at(1000)).requests, SizeIs(2)) << "one of each";
  EXPECT_THAT(intake_.add_map(one_), SizeIs(2));
}

TEST_F(TaskIntakeTest, GivesUpWhatDoesNotComeAndNamesIt) {
  intake_.add_map(zero_);
  intake_.add(job(zero_, one_, 1), at(0));
  intake_.add(job(zero_, two_, 2), at(700));
  EXPECT_THAT(intake_.check(at(1999)).given_up, IsEmpty());
  const TaskIntake::Due due = intake_.check(at(2000));
  ASSERT_THAT(due.given_up, SizeIs(1));
  EXPECT_EQ(due.given_up[0].job.ticket, 1U);
  EXPECT_THAT(due.given_up[0].why, HasSubstr("local map 1 ("));
  EXPECT_EQ(intake_.waiting(), 1U);
  EXPECT_FALSE(intake_.lacks(topomap::content_hash(*one_)));
  EXPECT_THAT(intake_.check(at(2700)).given_up, SizeIs(1));
  EXPECT_FALSE(intake_.next_check());
  // A later task starts over.
  intake_.add(job(zero_, one_, 3), at(3000));
  EXPECT_EQ(intake_.next_check(), at(3020));
}

TEST_F(TaskIntakeTest, AJobKeepsTheMapThatCameFirstEvenWithoutMemory) {
  IntakeOptions options;
  options.map_bytes = 1;
  TaskIntake intake(options);
  intake.add(job(zero_, one_, 1), at(0));
  EXPECT_THAT(intake.add_map(zero_), IsEmpty());
  EXPECT_THAT(intake.add_map(two_), IsEmpty());
  EXPECT_EQ(intake.maps().size(), 1U);
  EXPECT_THAT(intake.add_map(one_), SizeIs(1));
  // A dropped map is requested again.
  EXPECT_FALSE(intake.add(job(zero_, one_, 2), at(10)));
  EXPECT_THAT(intake.check(at(30)).requests, SizeIs(1));
}

TEST_F(TaskIntakeTest, ForgetsAClientThatIsGone) {
  intake_.add(job(zero_, one_, 1, "goes"), at(0));
  intake_.add(job(zero_, one_, 2, "stays"), at(0));
  intake_.remove("goes");
  EXPECT_EQ(intake_.waiting(), 1U);
  const TaskIntake::Due due = intake_.check(at(100));
  ASSERT_THAT(due.requests, SizeIs(2));
  EXPECT_EQ(due.requests[0].client_id, "stays");
}

TEST_F(TaskIntakeTest, APartOfASearchWaitsForAllPiecesOfTheMap) {
  const auto field = place_field();
  ASSERT_EQ(field->pieces().size(), 2U);
  EXPECT_FALSE(intake_.add(place_job(*field, 1), at(0)));
  const TaskIntake::Due due = intake_.check(at(0));
  ASSERT_THAT(due.requests, SizeIs(2)) << "nobody publishes them";
  EXPECT_EQ(due.requests[0].map_id, localization::PlaceField::kFirstPiece);
  EXPECT_EQ(due.requests[1].map_id, localization::PlaceField::kFirstPiece + 1);
  EXPECT_THAT(intake_.add_map(field->pieces()[1]), IsEmpty());
  EXPECT_THAT(intake_.check(at(1000)).requests, SizeIs(1));
  const auto ready = intake_.add_map(field->pieces()[0]);
  ASSERT_THAT(ready, SizeIs(1));
  EXPECT_EQ(ready[0].pieces, field->pieces());
  EXPECT_TRUE(intake_.add(place_job(*field, 2), at(1000)));
}

TEST_F(TaskIntakeTest, APieceThatDoesNotComeIsNamed) {
  const auto field = place_field();
  intake_.add_map(field->pieces()[0]);
  EXPECT_FALSE(intake_.add(place_job(*field, 1), at(0)));
  const TaskIntake::Due due = intake_.check(at(2000));
  ASSERT_THAT(due.given_up, SizeIs(1));
  EXPECT_THAT(due.given_up[0].why, HasSubstr("local map 2147483649 ("));
}

}  // namespace
}  // namespace topogeo::search_pool
