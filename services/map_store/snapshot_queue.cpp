#include "snapshot_queue.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/snapshot_pieces.hpp"

namespace topogeo::map_store {

namespace {

bool same_request(const msg::SnapshotRequest& a, const msg::SnapshotRequest& b) {
  return a.request_id() == b.request_id() && a.client_id() == b.client_id();
}

}  // namespace

SnapshotQueue::SnapshotQueue(std::string robot_id, Source source, Send send)
    : robot_id_(std::move(robot_id)), source_(std::move(source)), send_(std::move(send)) {}

void SnapshotQueue::add(const msg::SnapshotRequest& request) {
  const auto same = [&](const auto& other) { return same_request(request, other); };
  if ((answer_ && same(answer_->request)) || std::ranges::any_of(waiting_, same)) return;
  if (waiting_.size() < kMostRequests) {
    waiting_.push_back(request);
  } else if (refused_requests_.size() < kMostRequests) {  // beyond, there is no reply
    refused_requests_.push_back(request);
  }
}

void SnapshotQueue::make_next(Clock::time_point now) {
  answer_ = Answer{};
  answer_->last_sent = now;
  if (!refused_requests_.empty()) {
    answer_->request = refused_requests_.front();
    refused_requests_.pop_front();
    answer_->message = "too many requests are waiting, try again later";
    return;
  }
  answer_->request = waiting_.front();
  waiting_.pop_front();
  try {
    source_(answer_->request, [&](std::string_view bytes) { answer_->bytes += bytes; });
    answer_->pieces = service::piece_count(answer_->bytes.size());
  } catch (const std::exception& error) {
    answer_->bytes.clear();
    answer_->message = error.what();
  }
}

msg::SnapshotPiece SnapshotQueue::piece(const Answer& answer) const {
  msg::SnapshotPiece out;
  messaging::set_header(out, robot_id_, answer.request.stamp_ns(), sent_);
  messaging::set_client_id(out, answer.request.client_id().to_string());
  out.request_id(answer.request.request_id());
  messaging::set_text_cut(out.message(), answer.message);
  if (answer.pieces > 0) service::cut_piece(out, answer.bytes, answer.next);
  return out;
}

bool SnapshotQueue::work(Clock::time_point now, std::chrono::milliseconds slice) {
  const Clock::time_point end = now + slice;
  while (answer_ || !waiting_.empty() || !refused_requests_.empty()) {
    if (!answer_) make_next(now);
    if (!send_(piece(*answer_))) {
      if (now - answer_->last_sent < kPatience) return false;
      ++given_up_;
      answer_.reset();
      continue;
    }
    ++sent_;
    ++answer_->next;
    answer_->last_sent = now;
    if (answer_->next >= answer_->pieces) {
      ++(answer_->pieces == 0 ? refused_ : served_);
      answer_.reset();
    }
    if (Clock::now() >= end) return !answer_ && waiting_.empty() && refused_requests_.empty();
  }
  return true;
}

}  // namespace topogeo::map_store
