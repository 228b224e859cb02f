"""rosbag_check.py BAG OUT COMPRESSION: reads a bag with rosbag, decodes its messages by the definitions in it,
and writes them into another. Exit code 77 where rosbag is not installed."""
import sys

try:
    import rosbag
except ImportError as error:
    print("no rosbag:", error)
    sys.exit(77)


def main():
    source, target, compression = sys.argv[1:]
    counts = {}
    with rosbag.Bag(source) as bag, rosbag.Bag(target, "w", compression=compression) as out:
        for topic, message, time in bag.read_messages():
            counts[topic] = counts.get(topic, 0) + 1
            if topic == "/scan":
                assert len(message.ranges) == 7, len(message.ranges)
                assert message.header.frame_id == "laser", message.header.frame_id
                assert message.angle_min == -0.75, message.angle_min
                assert message.ranges[6] == float("inf"), message.ranges[6]
            if topic == "/odom":
                assert message.child_frame_id == "base_link"
            if topic == "/tf_static":
                assert abs(message.transforms[0].transform.translation.x - 0.2) < 1e-12
            out.write(topic, message, time)
    assert counts == {"/tf_static": 1, "/odom": 20, "/tf": 20, "/scan": 20}, counts


main()
