// Readers of Fast DDS 2.9.1 that end are still told of writers, in two ways.
//
// When it has found a writer for a reader it tells the reader's listener, and looks for it anew
// each time (EDP::pairing_remote_writer_with_local_reader_after_security and others). A reader that
// ends meanwhile has none from one look to the next. The reader itself stays until all is told: who
// removes it waits for the lock of all endpoints. Here there is always a listener. The function
// takes the place of the library's, which calls it through its symbol and does no more with a
// listener than to tell it.
//
// When a writer is not alive any more, or again, WLP::sub_liveliness_changed goes through the list
// of readers and tells their listeners, in the thread of timers and without a lock; a reader that
// ends meanwhile is taken from the list and deleted. Here who takes one from the list waits until
// nobody goes through it. It holds no lock then (RTPSParticipantImpl::deleteUserEndpoint), so that
// it keeps nobody from getting through; and who goes through waits for nobody but while one is
// taken out. Left as it is: a reader that is added may move the list meanwhile. It takes a
// lock of discovery for that, so that one of ours around it could end in a deadlock.
//
// Should a library have no such functions, nothing calls these.
#include "reader_end.hpp"

#include <condition_variable>
#include <cstdint>
#include <mutex>

#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>

#include "library_function.hpp"

namespace rtps = eprosima::fastrtps::rtps;

namespace topogeo::messaging {
namespace {

/// Of the lists of readers of all participants: who goes through one keeps others from taking a
/// reader out. Unlike with a std::shared_mutex, who goes through may do so again inside, and waits
/// for nobody who waits.
class Passages {
 public:
  static Passages& of_process() {
    static Passages passages;
    return passages;
  }
  template <class Function>
  void through(const Function& function) {
    const Passage passage(*this);
    function();
  }
  template <class Function>
  auto between(const Function& function) {
    std::unique_lock lock(mutex_);
    over_.wait(lock, [this] { return under_way_ == 0; });
    return function();
  }

 private:
  class Passage {
   public:
    explicit Passage(Passages& all) : all_(all) {
      const std::lock_guard lock(all_.mutex_);
      ++all_.under_way_;
    }
    Passage(const Passage&) = delete;
    Passage& operator=(const Passage&) = delete;
    ~Passage() {
      const std::lock_guard lock(all_.mutex_);
      if (--all_.under_way_ == 0) all_.over_.notify_all();
    }

   private:
    Passages& all_;
  };

  std::mutex mutex_;
  std::condition_variable over_;
  int under_way_ = 0;
};

}  // namespace
}  // namespace topogeo::messaging

using topogeo::messaging::library_function;
using topogeo::messaging::Passages;

// Arguments are passed on as they come: a WLP, GUID, kind, duration, and two counts; a WLP and
// reader.
using LivelinessChanged = void(void*, const void*, const void*, const void*, std::int32_t,
                               std::int32_t);
using RemoveLocalReader = bool(void*, rtps::RTPSReader*);

// NOLINTBEGIN: the names of member functions of the library
extern "C" rtps::ReaderListener* topogeo_listener_of(const rtps::RTPSReader* reader) __asm__(
    "_ZNK8eprosima8fastrtps4rtps10RTPSReader11getListenerEv");
extern "C" LivelinessChanged topogeo_liveliness_changed __asm__(
    "_ZN8eprosima8fastrtps4rtps3WLP22sub_liveliness_changedERKNS1_6GUID_"
    "tERKNS_7fastdds3dds23LivelinessQosPolicyKindERKNS0_6Time_tEii");
extern "C" RemoveLocalReader topogeo_remove_local_reader __asm__(
    "_ZN8eprosima8fastrtps4rtps3WLP19remove_local_readerEPNS1_10RTPSReaderE");
// NOLINTEND

extern "C" rtps::ReaderListener* topogeo_listener_of(const rtps::RTPSReader* reader) {
  using Function = rtps::ReaderListener* (*)(const rtps::RTPSReader*);
  static const auto original =
      library_function<Function>("_ZNK8eprosima8fastrtps4rtps10RTPSReader11getListenerEv");
  static rtps::ReaderListener nobody;
  rtps::ReaderListener* const listener = original(reader);
  return listener == nullptr ? &nobody : listener;
}

extern "C" void topogeo_liveliness_changed(void* protocol, const void* writer, const void* kind,
                                           const void* lease, std::int32_t alive,
                                           std::int32_t not_alive) {
  static const auto original = library_function<LivelinessChanged*>(
      "_ZN8eprosima8fastrtps4rtps3WLP22sub_liveliness_changedERKNS1_6GUID_"
      "tERKNS_7fastdds3dds23LivelinessQosPolicyKindERKNS0_6Time_tEii");
  Passages::of_process().through(
      [&] { original(protocol, writer, kind, lease, alive, not_alive); });
}

extern "C" bool topogeo_remove_local_reader(void* protocol, rtps::RTPSReader* reader) {
  static const auto original = library_function<RemoveLocalReader*>(
      "_ZN8eprosima8fastrtps4rtps3WLP19remove_local_readerEPNS1_10RTPSReaderE");
  return Passages::of_process().between([&] { return original(protocol, reader); });
}

namespace topogeo::messaging {

void let_readers_end_beside_peers() {}

}  // namespace topogeo::messaging
