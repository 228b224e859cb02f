#include "../corrections.hpp"

#include "../security.hpp"
#include "announcement_shield.hpp"
#include "filter_info.hpp"
#include "fragments.hpp"
#include "handshake_certificates.hpp"
#include "reader_end.hpp"
#include "reader_removal.hpp"
#include "security_keys.hpp"
#include "timer_waits.hpp"
#include "writer_end.hpp"
#include "writer_permissions.hpp"

namespace topogeo::messaging {

void correct_fast_dds() {
  correct_fragments();
  keep_filter_info_out();
  let_timers_end_alone();
  let_readers_end_beside_peers();
  let_readers_leave_beside_sending();
  let_writers_end_undisturbed();
}

void fit_packets(eprosima::fastdds::dds::DomainParticipantQos& /*qos*/) {}  // fragments.cpp does

void correct_security() {
  check_encrypted_announcements();
  keep_security_races_away();
  keep_one_certificate_of_a_peer();
  keep_security_keys();
  note_denials();
  note_writer_permissions();
}

}  // namespace topogeo::messaging
