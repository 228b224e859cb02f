// Reads all topics with Cyclone DDS: another implementation, whose types come from the same IDL.
//
//   cyclone_reader DOMAIN PARTITION
//
// Prints "sample TOPIC" for each sample and "disposed TOPIC" for each instance that is disposed,
// until it is killed. Exit code 1 with a line on standard error when it cannot.
#include <stdio.h>
#include <stdlib.h>

#include "archive.h"
#include "body.h"
#include "common.h"
#include "dds/dds.h"
#include "drawing.h"
#include "hybrid_map.h"
#include "local_map.h"
#include "map_update.h"
#include "match.h"
#include "merge.h"
#include "motion.h"
#include "planning.h"
#include "search.h"
#include "sensor.h"
#include "simulation.h"
#include "status.h"
#include "store.h"
#include "stream.h"
#include "trajectory.h"

struct Topic {
  const char* name;
  const dds_topic_descriptor_t* type;
};

static const struct Topic kTopics[] = {
#define TOPOGEO_TOPIC(type, name, role, replay_role, addressee) \
  {TOPOGEO_TOPIC_PREFIX name, &topogeo_msg_##type##_desc},
#include "topogeo/messaging/topics.def"
};
enum { kTopicCount = sizeof(kTopics) / sizeof(kTopics[0]), kSamples = 8 };

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "cyclone_reader: %s: %s\n", what, dds_strretcode(-entity));
  exit(1);
}

static void report(dds_entity_t reader, const char* name) {
  void* samples[kSamples] = {0};
  dds_sample_info_t infos[kSamples];
  for (;;) {
    const dds_return_t count =
        checked(dds_take(reader, samples, infos, kSamples, kSamples), "dds_take");
    for (dds_return_t i = 0; i < count; ++i) {
      if (infos[i].valid_data) printf("sample %s\n", name);
      if (infos[i].instance_state == DDS_IST_NOT_ALIVE_DISPOSED) printf("disposed %s\n", name);
    }
    if (count > 0) dds_return_loan(reader, samples, count);
    if (count < kSamples) break;
  }
  fflush(stdout);
}

int main(int argc, char** argv) {
  if (argc != 3) {
    fprintf(stderr, "cyclone_reader: expected DOMAIN PARTITION\n");
    return 2;
  }
  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)strtoul(argv[1], NULL, 10), NULL, NULL),
              "participant");
  dds_qos_t* subscriber_qos = dds_create_qos();
  dds_qset_partition1(subscriber_qos, argv[2]);
  const dds_entity_t subscriber =
      checked(dds_create_subscriber(participant, subscriber_qos, NULL), "subscriber");
  // What every writer offers, reliable or not, for late readers or not.
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_entity_t readers[kTopicCount];
  for (int i = 0; i < kTopicCount; ++i) {
    const dds_entity_t topic =
        checked(dds_create_topic(participant, kTopics[i].type, kTopics[i].name, NULL, NULL),
                kTopics[i].name);
    readers[i] = checked(dds_create_reader(subscriber, topic, qos, NULL), kTopics[i].name);
  }
  printf("ready\n");
  fflush(stdout);
  for (;;) {
    for (int i = 0; i < kTopicCount; ++i) report(readers[i], kTopics[i].name);
    dds_sleepfor(DDS_MSECS(10));
  }
}
