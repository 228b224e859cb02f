// Texts of the view Time; texts.ts has all others.
import { count, duration } from "./format";
import { MergedMap } from "./protocol";

export const time_texts = {
  film: "Play the drive",
  film_hint: "How the map came to be: the robot, what it saw, and the floor known until then.",
  film_note: "The drive as it was, not the robot of now",
  load: "Load the drive",
  fetching: (stops: number, total: number) => `Fetched ${count(stops)} of ${count(total)} stops …`,
  loading: (stops: number, total: number) => `Laid out ${count(stops)} of ${count(total)} stops …`,
  no_drive: "The map has no stops: nobody has driven it.",
  drive: (stops: number, seconds: number) =>
    `${count(stops)} stops, ${duration(seconds)} without the pauses.`,
  slider: "Moment of the drive",
  play: "Play",
  pause: "Pause",
  speed: "Speed",
  times: (speed: number) => `${speed} ×`,
  close: "Back to now",
  moment: (stop: number, total: number, when: string) =>
    `Stop ${count(stop)} of ${count(total)}, ${when}`,
  snapshots: "Snapshots",
  no_snapshots: "There is no snapshot yet.",
  name: "Name",
  name_rule: "Letters, digits, '.', '-' and '_', without spaces; no '.' first.",
  make: "Make a snapshot",
  made: "The snapshot is made.",
  snapshot_facts: (when: string, stops: number, bytes: number) =>
    `${when}, ${count(stops)} stops, ${(bytes / 1e6).toFixed(1)} MB`,
  restore: "Restore",
  restore_warning:
    "The map becomes what it was, without what was mapped since; that of now is kept as a " +
    "snapshot. A robot that is under way goes on from there: cancel its goal first.",
  restore_sure: "Restore it",
  restored: "The map is restored.",
  merge: "Merge with another map",
  merge_hint:
    "A map file (map.pb) of the same place, of this robot or another one. You see what would " +
    "change before anything does.",
  merge_file: "Map file",
  merge_too_large: (name: string) => `${name} is larger than 64 MB, which is the limit here.`,
  merging: (name: string) => `Looking for the place of ${name} in the map …`,
  not_merged: (name: string) => `${name} was not merged.`,
  merged: (name: string) => `${name} joins the map`,
  merged_facts: (made: MergedMap) =>
    `${count(made.joined)} stops of the smaller map find their place in the larger one` +
    (made.left_out > 0 ? `, ${count(made.left_out)} do not and are left out` : "") +
    `. Confidence ${(100 * made.confidence).toFixed(0)} %: ${count(made.agreeing)} of ` +
    `${count(made.searched)} places agree, within ${(100 * made.sigma_m).toFixed(0)} cm.`,
  merge_warning:
    "Accepted, this becomes the map; that of now is kept as a snapshot. A robot that is under way " +
    "looks for its place in it.",
  merge_accept: "Make it the map",
  merge_refuse: "Discard it",
  merge_accepted: "The maps are one.",
  merge_refused: "The map stays as it is.",
  comparison: "Compare",
  compare_hint: "What differs between two versions of the map, on the map in colours.",
  before: "Before",
  after: "After",
  now: "the map of now",
  compare: "Compare",
  comparing: "Comparing …",
  hide: "Hide",
  stops: "Stops",
  stops_value: (before: number, after: number) => `${count(before)} before, ${count(after)} after`,
  changes: { gone: "Gone", new: "New", seen: "Seen since", lost: "Not known any more" },
  export: "Export",
  export_hint: "The map of now as a file for other programs.",
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
    g2o: "pose graph of the stops",
    svg: "picture",
    png: "picture",
    tum: "corrected pose of each scan",
    carmen: "scans of the stops as a log",
    pb: "the whole map",
  } as Record<string, string>,
};
