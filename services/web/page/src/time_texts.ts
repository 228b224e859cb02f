// Texts of the view Time; texts.ts has all others.
import { count, duration } from "./format";
import { MergedMap } from "./protocol";

export const time_texts = {
  film: "Play the drive",
  film_hint: "Replays the drive that made the map: the robot, its scans, and the floor known until then.",
  film_note: "Replay of the drive, not the present robot",
  load: "Load the drive",
  fetching: (stops: number, total: number) => `Fetched ${count(stops)} of ${count(total)} scan points …`,
  loading: (stops: number, total: number) => `Laid out ${count(stops)} of ${count(total)} scan points …`,
  no_drive: "The map has no scan points, so there is no drive to play.",
  drive: (stops: number, seconds: number) =>
    `${count(stops)} scan points, ${duration(seconds)} without the pauses.`,
  slider: "Moment of the drive",
  play: "Play",
  pause: "Pause",
  speed: "Speed",
  times: (speed: number) => `${speed} ×`,
  close: "Back to now",
  moment: (stop: number, total: number, when: string) =>
    `Scan point ${count(stop)} of ${count(total)}, ${when}`,
  snapshots: "Snapshots",
  no_snapshots: "There is no snapshot yet.",
  name: "Name",
  name_rule: "Letters, digits, '.', '-' and '_'; no spaces, no '.' at the start.",
  make: "Make a snapshot",
  made: "The snapshot is made.",
  snapshot_facts: (when: string, stops: number, bytes: number) =>
    `${when}, ${count(stops)} scan points, ${(bytes / 1e6).toFixed(1)} MB`,
  restore: "Restore",
  rename: "Rename",
  new_name: (name: string) => `New name of ${name}`,
  delete: "Delete",
  delete_sure: (name: string) => `Delete ${name} for good`,
  changed: "The snapshots are changed.",
  restore_warning:
    "The snapshot replaces the present map, which is kept as another snapshot. Data mapped since is left " +
    "out. A robot under way continues in the restored map, so cancel its goal first.",
  restore_sure: "Restore it",
  restored: "The map is restored.",
  merge: "Merge with another map",
  merge_hint:
    "Choose a map file (map.pb) of the same place, of this robot or another one. The page shows the " +
    "changes before you accept them.",
  merge_file: "Map file",
  merge_too_large: (name: string) => `${name} is larger than 64 MB, which is the limit here.`,
  merging: (name: string) => `Aligning ${name} with the map …`,
  not_merged: (name: string) => `${name} was not merged.`,
  merged: (name: string) => `${name} joins the map`,
  merged_facts: (made: MergedMap) =>
    `${count(made.joined)} scan points of the smaller map join the larger one` +
    (made.left_out > 0 ? `, ${count(made.left_out)} do not and are left out` : "") +
    `. Confidence ${(100 * made.confidence).toFixed(0)} %: ${count(made.agreeing)} of ` +
    `${count(made.searched)} places agree, within ${(100 * made.sigma_m).toFixed(0)} cm.`,
  merge_warning:
    "The merged map replaces the present map if you accept it; the present map is kept as a " +
    "snapshot. A robot under way finds its position in the merged map.",
  merge_accept: "Make it the map",
  merge_refuse: "Discard it",
  merge_accepted: "The maps are merged.",
  merge_refused: "The map stays as it is.",
  comparison: "Compare",
  compare_hint: "Shows the differences between two versions of the map in colours.",
  before: "Before",
  after: "After",
  now: "present map",
  compare: "Compare",
  comparing: "Comparing …",
  hide: "Hide",
  stops: "Scan points",
  stops_value: (before: number, after: number) => `${count(before)} before, ${count(after)} after`,
  changes: { gone: "Gone", new: "New", seen: "Seen since", lost: "No longer known" },
  export: "Export",
  export_hint: "Saves the present map as a file for other programs.",
  picture_shows: "Pictures show",
  picture_odometry: "odometry",
  picture_loops: "loops",
  download: "Download",
  download_file: (file: string) => `Download ${file}`,
  formats: {
    pgm: "grid, for map_server of ROS",
    masks: "zones as masks, for costmap filters of Nav2",
    geojson: "graph, places and zones, for the route server of Nav2",
    lif: "graph and places, Layout Interchange Format",
    zones: "zones, VDA 5050",
    rmf: "graph, for Open-RMF",
    graphml: "graph without loss, for graph programs",
    g2o: "pose graph of the scan points",
    svg: "picture",
    png: "picture",
    tum: "corrected position of each scan",
    carmen: "scans of the scan points as a log",
    pb: "the whole map",
  } as Record<string, string>,
};
