# Starts topogeo beside the nodes of a robot, in place of slam_toolbox or AMCL:
#
#   ros2 launch topogeo.launch.py                          maps
#   ros2 launch topogeo.launch.py map:=/maps/map.pb        follows the robot in a map
#   ros2 launch topogeo.launch.py laser:=0.2,0,0           where the laser is: ros_bridge --show-mounting 30
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction


def start(context):
    value = context.launch_configurations
    laser = [f"--laser={value['laser']}"]
    stored = ["--map", value["map"]] if value["map"] else []
    store = stored or ["--out", value["out"]]
    programs = [
        ["topogeo-map-store", *store],
        ["topogeo-localizer", *laser, *stored],
        ["topogeo-local-mapper", *laser],
        ["topogeo-planner"],
        ["topogeo-ros-bridge", *laser],
    ]
    if value["drive"] == "true":
        programs.append(["topogeo-navigator", *laser])
    return [ExecuteProcess(cmd=program, output="log", respawn=True) for program in programs]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("laser", default_value="0,0,0"),
        DeclareLaunchArgument("map", default_value=""),
        DeclareLaunchArgument("out", default_value="map"),
        DeclareLaunchArgument("drive", default_value="false"),
        OpaqueFunction(function=start),
    ])
