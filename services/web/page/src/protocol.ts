// Messages to and from the service, described in docs/web.md. Metres, radians, seconds, map frame.

export interface Pose {
  stamp_s: number;
  sequence: number;
  state: "TRACKING" | "AMBIGUOUS" | "SEARCHING" | "LOST";
  mode: "mapping" | "localization";
  confidence: number | null;
  x_m: number; // meaningless in SEARCHING and LOST, like y_m and theta_rad
  y_m: number;
  theta_rad: number;
  covariance: (number | null)[]; // 3 x 3, row-major
  reason: string;
  footprint_m?: [number, number][]; // corners, robot frame; missing: a round robot
}

export interface Scan {
  points_robot_m: number[]; // x, y of each hit, robot frame
  x_m?: number; // of the robot at that scan; missing if its pose is not known
  y_m?: number;
  theta_rad?: number;
  fits?: boolean; // false: not on the walls of the finished map; missing if that is not known
}

export interface Navigator {
  state: "idle" | "driving" | "relocalizing" | "blocked" | "arrived" | "stopped";
  reason: string;
  message: string;
  goal_id: string;
  driven_m: number | null;
  rest_m: number | null;
  rest_s: number | null;
  linear_mps: number | null;
  free_ahead_m: number | null;
  detours: number;
  guard_stops: number;
}

export interface PointM {
  x_m: number;
  y_m: number;
}

export interface Route {
  found: boolean;
  message: string;
  length_m: number | null;
  points_m: number[];
  nearest_reachable?: PointM;
}

export interface Preview extends Partial<Route> {
  found: boolean;
  time_s?: number | null;
  min_clearance_m?: number | null;
  goal?: number; // index of the goal without a route
}

export interface Goals {
  current: { goal_id: string; text: string; x_m?: number; y_m?: number } | null;
  waiting: { text: string }[];
  waits_s?: number | null; // left at the current goal when this was sent
  round?: { now: number; of: number } | null; // of: 0 until it is cancelled
  exploring: boolean;
  pausing?: boolean; // ordered, and not reported by the navigator
  exploration?: { visited: number; given_up: number; ended: boolean } | null;
  interrupted?: { text: string; waiting: number; exploring: boolean } | null; // by a stop
}

export interface Controls {
  holder: { page: number; name: string } | null;
  asking: { page: number; name: string } | null;
  stopped_by: string;
}

export interface Drive {
  held: boolean;
  linear_mps: number | null;
  angular_radps: number | null;
  free_ahead_m?: number | null;
  free_behind_m?: number | null;
  message: string;
  stopped?: boolean; // by a stop that no base reports
}

export interface Base {
  state: string;
  reason: string;
  stands: boolean;
  battery_v: number | null;
  battery_low: boolean;
  battery_percent: number | null; // null: the base does not measure it
}

export interface Laser {
  state: string;
  reason: string;
  scans_per_s: number | null;
}

export interface MapInfo {
  version: string | number;
  columns: number;
  rows: number;
  resolution_m: number;
  frame: string;
  x_m: number; // lower left corner of cell (0, 0)
  y_m: number;
  theta_rad: number;
}

export interface Pose2 {
  x_m: number;
  y_m: number;
  theta_rad: number;
}

export type NodeKind = "real" | "fictitious" | "virtual" | "door" | "narrowing" | "hall_corridor";

export interface LocalMap {
  session: string;
  number: number;
  x_m?: number; // pose of the stop on the map; missing if unknown
  y_m?: number;
  theta_rad?: number;
  laser_m?: [number, number]; // in the robot frame at the stop, like the following fields
  nodes: [number, number, NodeKind][];
  branches: number[][];
  points_m: number[];
}

/** x, y, heading, fitness: metres, radians, [0, 1]; map frame. */
export type Hypothesis = [number, number, number, number | null];

export interface SearchedMatch extends Pose2 {
  // x_m .. of the prediction, the centre of the search space
  base_theta_rad: number; // heading of the search space and of the covariance
  half_widths: [number, number, number];
  covariance: (number | null)[];
  done: boolean;
  accepted?: boolean;
  reason?: string;
  fitness?: number | null;
  hypotheses: Hypothesis[];
}

export interface Search {
  stamp_s: number;
  tasks: number;
  running: boolean;
  whole_map: boolean;
  matches: SearchedMatch[];
  hypotheses: Hypothesis[];
}

export interface Values {
  pose: Pose;
  scan: Scan;
  navigator: Navigator;
  route: Route;
  goals: Goals;
  controls: Controls;
  drive: Drive;
  base: Base;
  laser: Laser;
  map: MapInfo;
  truth: { x_m: number; y_m: number; theta_rad: number; collisions: number };
  local_map: LocalMap;
  drawing: { version: string };
  search: Search;
  viewers: { viewers: number; operators: number };
  time: { time_s: number; ages_s?: Record<string, number> }; // age of each value
}

export interface Room extends PointM {
  name: string;
  area_m2: number;
  color: number;
}

export interface Rule {
  kind: "no_go" | "slow" | "one_way" | "preferred";
  value: number | null;
  corners_m: number[];
}

export interface GraphObject {
  // n12
  kind?: NodeKind;
  x_m?: number;
  y_m?: number;
  // b7
  virtual?: boolean;
  points_m?: number[];
  // map
  nodes?: number;
  branches?: number;
}

export interface Loop extends Pose2 {
  // x_m .. of the later stop in the frame of the earlier one, as matched
  step: number;
  earlier: number;
  later: number;
  accepted: boolean;
  outcome: "accepted" | "gate" | "unconfirmed" | "no_closing" | "outvoted";
  explanation: string;
  source: "prediction" | "place" | "window";
  predicted?: Pose2 & { covariance: (number | null)[] }; // the same before the match
  correction_m: number | null;
  correction_rad: number | null;
  fitness: number | null;
  probability: number | null;
}

/** A stop of the drive behind a map; x_m .. missing if the robot was not located. */
export interface DriveStop extends Partial<Pose2> {
  stamp_s: number;
  outline_cm?: number[]; // x, y of scan points, robot frame
  starts_drive?: boolean;
}

export interface DrivePart {
  total: number;
  first: number;
  stops: DriveStop[];
  laser_m?: [number, number];
}

export interface Snapshot {
  name: string;
  time_s: number;
  bytes: number;
  stops?: number;
  damage?: string;
}

export interface Snapshots {
  kept?: boolean; // false: the map store keeps none, for the reason of `message`
  message?: string;
  snapshots: Snapshot[];
}

interface ComparedVersion {
  name: string;
  stops: number;
  version: string;
}

export interface Comparison extends Pose2 {
  before: ComparedVersion;
  after: ComparedVersion;
  columns: number;
  rows: number;
  resolution_m: number;
  gone_m2: number;
  new_m2: number;
  seen_m2: number;
  lost_m2: number;
  picture: string;
}

/** The effect of a merge with a map file. */
export interface MergedMap extends Comparison {
  number: number;
  joined: number;
  left_out: number;
  confidence: number;
  sigma_m: number;
  agreeing: number;
  searched: number;
}

export interface ExportFormats {
  formats: { format: string; files: string[] }[];
}

export interface Service {
  service: string;
  host: string;
  state: string;
  message: string;
  waits_for: string;
  input: string;
  input_rate_per_s: number | null;
  input_age_s: number | null;
  faults: number;
  last_error: string;
  cpu_s: number | null;
  memory_bytes: number | null;
  version: string;
}

export interface Worker {
  name: string;
  host: string;
  slots: number;
  in_hand: number;
  load: number | null;
  tasks_per_s: number | null;
  tasks_done: number;
  failures: number;
  draining: boolean;
}

export interface Merge {
  state: "open" | "accepted" | "refused" | "withdrawn";
  robot: string;
  other_robot: string;
  confidence: number | null;
  stops: number;
  distance_m: number | null;
  matches: number;
  fitness: number | null;
  contradicted: number | null;
}

export interface LogEvent {
  time_s: number;
  level: "info" | "warning" | "error";
  source: string;
  text: string;
}

/** A trouble that stays until somebody acknowledges it. */
export interface Alarm extends Omit<LogEvent, "time_s"> {
  first_s: number;
  time_s: number; // of the last time
  count: number;
  acknowledged_by: string; // empty: nobody yet
  acknowledged_s?: number;
}

export interface Tables {
  tiles: number;
  rooms: Room;
  places: PointM;
  rules: Rule;
  graph: GraphObject;
  trail: ([number, number, number] | null)[];
  loops: Loop;
  services: Service;
  workers: Worker;
  merges: Merge;
  events: LogEvent;
  alarms: Alarm;
}

export type ValueName = keyof Values;
export type TableName = keyof Tables;

export const tableNames: readonly TableName[] = [
  "tiles",
  "rooms",
  "places",
  "rules",
  "graph",
  "trail",
  "loops",
  "services",
  "workers",
  "merges",
  "events",
  "alarms",
];

export interface ValueMessage {
  channel: ValueName;
  version: number;
  value: unknown;
}

export interface TableMessage {
  channel: TableName;
  from: number; // 0: a snapshot
  version: number;
  set: Record<string, unknown>;
  gone: string[];
}

export interface Info {
  protocol: number;
  robot_id: string;
  version: string;
  life: string;
  may_write: boolean;
  offers?: string[];
}

export type Goal = ({ place: string } | PointM) & { heading_rad?: number; wait_s?: number };
