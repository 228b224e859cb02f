// All texts of the page, in English; spanish.ts has them in Spanish. Another language is another object of this type.
import { activity_texts, controls_texts } from "./header_texts";
import { draw_texts } from "./draw_texts";
import { area, counted, degrees, duration, length, Maybe, percent, point, speed } from "./format";
import { alarm_texts, mission_texts, report_texts } from "./shift_texts";
import { spanish } from "./spanish";
import { stored_language } from "./language";
import { time_texts } from "./time_texts";
import { understand_texts } from "./understand_texts";

export const english = {
  title: "topogeo",
  language: "en",
  no_robot: "robot",

  states: {
    TRACKING: "Position known",
    AMBIGUOUS: "Position unsure",
    SEARCHING: "Searching",
    LOST: "Position lost",
    misplaced: "Wrong position",
    none: "No position",
    absent: "No robot",
    silent: "No position",
    offline: "Offline",
  },
  reasons: {
    TRACKING: "The laser fits the map.",
    AMBIGUOUS: "Not sure where it is: the laser fits more than one place, or none.",
    SEARCHING: "Looking for its place on the map. Drive it on, or set its position.",
    LOST: "The laser contradicts this place. Set the position, or search the whole map.",
    misplaced: "The laser does not fit here. Set the position, or search the whole map.",
    none: "The robot has not reported its position yet.",
    absent: "No robot connected. Map only.",
    silent: "No position for over ten seconds. The map shows the last one.",
    offline: "Nothing arrives from the robot. The page shows its last state.",
  },

  activity: activity_texts,

  views: {
    now: "Now",
    send: "Send",
    correct: "Correct",
    understand: "Understand",
    draw: "Draw",
    time: "Time, files",
  },
  map_label: "Map of the floor. Arrow keys move it, plus and minus zoom.",
  views_label: "Views",

  stop: "Stop",
  stop_title: "Stops the robot at once and holds it (Space)",
  view_only: "View only",
  view_only_title: "Open the operator's link, which has a token, to command the robot.",
  held: "Held. Release it to drive.",
  held_with_goal: (goal: string) => `Held. When released, the robot drives to ${goal} at once.`,
  hand_stopped: "Held, not confirmed by the drive unit. Release it to drive.",
  hand_stopped_with_goal: (goal: string) =>
    `Held, not confirmed by the drive unit. When released, the robot drives to ${goal} at once.`,
  interrupted_held: (text: string, goal: string) =>
    `${text} It was on the way to ${goal}; after the release you can resume.`,
  interrupted: (goal: string) => `Stopped on the way to ${goal}.`,
  resume_to: (goal: string) => `Resume: to ${goal}`,
  forget: "Forget it",
  and_more: (goal: string, more: number) =>
    more > 0 ? `${goal} and ${more} more` : goal,
  stop_sent: "Stop sent, not confirmed by the drive unit. The robot may still move.",
  stop_moves: "Stopping: the robot still moves.",
  stop_failed: (why: string) => `Stop was not accepted: ${why} The robot may still move.`,
  release_asks: (goal: string) => `When released, the robot drives to ${goal} at once.`,
  release_and_drive: "Release and drive",
  release_and_cancel: "Cancel the goal, then release",
  keep_held: "Keep it held",
  aged: (text: string, age_s: number) => `${text} (${duration(age_s)} old)`,
  emergency: "The emergency stop is pressed. Unlock it on the robot, then release it here.",
  release: "Release",
  low_battery: "The battery is low.",
  reconnecting: "Connection lost. Trying again …",
  wrong_token: "This link is wrong or has expired. You can only watch.",

  controls_of_robot: controls_texts,

  controls: {
    zoom_in: "Zoom in",
    zoom_out: "Zoom out",
    fit: "Show the whole map (F)",
    follow: "Follow the robot (R)",
    layers: "Layers of the map",
    turn: "Turn the map by 90°",
    measure: "Measure a distance",
    measuring: "Drag, or tap two points.",
    measured: (meters: number) => length(meters),
    theme: "Dark or light",
  },
  layers: {
    rooms: "Rooms in colours",
    names: "Names",
    drawing: "Drawn items",
    graph: "Nodes and branches",
    trail: "Trail of scan points",
    loops: "Accepted loops",
    scan: "Laser scan",
    local_map: "Voronoi diagram of the last scan point",
  },
  empty_map: {
    title: "No map yet",
    text: "The floor appears here as soon as the robot has mapped its first metres.",
    services: (names: string) => `Running services: ${names}.`,
    no_services: "No robot connected. “topogeo run” starts one.",
  },

  now: {
    robot: "Robot",
    mode: "Mode",
    modes: { mapping: "Mapping", localization: "Not mapping: the map stays as it is" },
    position: "Position",
    heading: "Heading",
    precision: "Accuracy (1 sigma)",
    speed: "Speed",
    sigma: (a: Maybe, b: Maybe, theta: Maybe) => `${length(a)} × ${length(b)}, ${degrees(theta)}`,
    unknown: "unknown",
    health: "At a glance",
    confidence: "Confidence of the position",
    workers: "Search workers",
    workers_value: (busy: number, slots: number, workers: number) =>
      `${counted(workers, "worker", "workers")}, ` +
      (busy > 0 ? `${busy} of ${slots} searches at a time` : "idle"),
    no_workers: "none connected",
    map: "Map",
    no_map: "none yet",
    map_value: (nodes: Maybe, branches: Maybe, floor: Maybe) =>
      `${area(floor)}, ${counted(nodes, "node", "nodes")}, ` +
      counted(branches, "branch", "branches"),
    loop: "Last accepted loop",
    loop_value: (points_ago: number) =>
      points_ago === 0
        ? "at this scan point"
        : `${counted(points_ago, "scan point", "scan points")} ago`,
    no_loop: "none yet",
    battery: "Battery",
    battery_value: (volts: Maybe, low: boolean, percent: Maybe) =>
      (typeof percent === "number" ? `${Math.round(percent)} %, ` : "") +
      `${typeof volts === "number" ? `${volts.toFixed(1)} V` : "–"}${low ? ", low" : ""}`,
    devices: "Laser and drive unit",
    laser: "Laser",
    base: "Drive unit",
    base_states: {
      ready: "ready",
      moving: "moving",
      offline: "not connected",
      starting: "starting",
      emergency_stop: "emergency stop",
      halted: "held",
      watchdog_expired: "stopped: no orders arrived",
      bumped: "bumped",
      joystick: "moved by its joystick",
      motors_off: "motors off",
    } as Record<string, string>,
    laser_states: {
      running: "running",
      offline: "not connected",
      starting: "starting",
      fault: "sends no usable scans",
    } as Record<string, string>,
    not_heard: "not connected",
    simulated: "True position of the simulated robot",
    simulated_hint:
      "The world file's coordinates. Position and heading above are the map's, which begins where the " +
      "robot started, so the numbers differ even if the position is right.",
    in_world: "In its world",
    collisions: (n: number) => counted(n, "collision", "collisions"),
    legend: "Legend and keys",
    viewers: (viewers: number, operators?: number) =>
      `${viewers} ${viewers === 1 ? "page is" : "pages are"} open` +
      (operators === undefined ? "." : `, ${operators} may command.`),
  },
  keys: [
    ["Space", "Stop"],
    ["F", "Show the whole map"],
    ["R", "Follow the robot"],
    ["1 – 6", "The views"],
  ],
  legend: {
    real: "Junction",
    door: "Door",
    narrowing: "Narrowing",
    hall_corridor: "Hall meets corridor",
    fictitious: "Fictitious node: end of the view",
  },

  alarms: alarm_texts,
  missions: mission_texts,
  report: report_texts,
  send: {
    heading: "Where to?",
    hint: "Tap the map, or choose a name.",
    search: "Find a room or a place",
    no_names: "The map has no rooms and no places yet. Tap a point on the map.",
    no_match: "No name matches.",
    place: "place",
    point: (x: number, y: number) => `Point ${point(x, y)}`,
    point_in: (room: string, x: number, y: number) => `Point in ${room} (${point(x, y)})`,
    planning: "Planning …",
    route: (meters: Maybe, seconds: Maybe, clearance: Maybe) =>
      `${length(meters)}, about ${duration(seconds)}` +
      (typeof clearance === "number" ? `, narrowest ${length(2 * clearance)} wide` : ""),
    no_route: "There is no route.",
    no_route_to: (name: string, reason: string) => `No route to ${name}: ${reason}.`,
    nearest: "Go to the nearest point that can be reached",
    go: "Go",
    misplaced: "The laser does not fit at this position, so the robot is probably elsewhere and would drive wrong.",
    drive_misplaced: "Drive all the same",
    go_all: (n: number) => `Go to all ${n} in this order`,
    heading_at_goal: "Heading at the goal (°), empty: any",
    append: "Add to the list",
    clear: "Clear",
    remove: (name: string) => `Remove ${name}`,
    list: "Goals in a row",
    list_length: (meters: Maybe, seconds: Maybe) =>
      `Together ${length(meters)}, about ${duration(seconds)}`,
    explore: "Explore",
    explore_title: "Drives to all places that are not mapped yet",
    return: "Return home",
    underway: "Under way",
    idle: "The robot has no goal.",
    foreign: "The robot has a goal that was not sent from here.",
    not_heard: "Nothing arrives from the robot, so its state is unknown.",
    to_explore: "places that are not mapped yet",
    to_foreign: "a goal that was not sent from here",
    exploring: "The robot explores by itself.",
    explored: "Exploration finished: everything that can be reached is mapped.",
    explored_facts: (visited: number, given_up: number, floor: Maybe) =>
      `${counted(visited, "place", "places")} visited` +
      (given_up > 0 ? `, ${given_up} of them not reached` : "") +
      `, ${area(floor)} mapped`,
    to: (goal: string) => `To ${goal}`,
    rest: (meters: Maybe, seconds: Maybe) => `${length(meters)} left, about ${duration(seconds)}`,
    rest_exploring: (meters: Maybe, seconds: Maybe) =>
      `${length(meters)} to the next point, about ${duration(seconds)}`,
    next_point: "Choosing the next point …",
    waiting: (names: string) => `Then: ${names}`,
    progress: "Driven share of the route",
    pause: "Pause",
    resume: "Resume",
    cancel: "Cancel",
    spectator: "You are watching. With the operator's link you can send the robot from here.",
    no_navigator: "The robot cannot be sent: its navigator is not running.",
    drive: "Drive by hand",
    drive_hint:
      "Hold a button, W A S D, an arrow key or the stick of a touch screen. The robot stops when you let go, " +
      "when you leave the page or when the connection drops. Space stops and holds it.",
    drive_on: "Take the controls",
    drive_off: "Let go of the controls",
    drive_speed: "Speed",
    forward: "Forward",
    backward: "Backward",
    turn_left: "Turn left",
    turn_right: "Turn right",
    drive_idle: "Nobody drives.",
    drive_stands: "Stands.",
    drive_state: (now: Maybe, ahead: Maybe, behind: Maybe) =>
      speed(now) +
      (typeof ahead === "number" ? `, ${length(ahead)} free ahead` : "") +
      (typeof behind === "number" ? `, ${length(behind)} free behind` : ""),
  },
  navigator: {
    idle: "Without a goal",
    driving: "Driving",
    relocalizing: "Finding its position",
    blocked: "Blocked",
    arrived: "Arrived",
    stopped: "Stopped",
  } as Record<string, string>,
  halts: {
    no_route: "There is no route to the goal.",
    cancelled: "The goal was cancelled.",
    pose_lost: "The position is lost.",
    no_map: "There is no map.",
    outside_map: "The robot is not on the map.",
    obstacle: "An obstacle that is not on the map is in the way.",
    no_scan: "The laser sends nothing.",
    sonar_silent: "The sonars hear nothing although an obstacle is near.",
    base_not_ready: "The drive unit takes no orders.",
    base_stuck: "The drive unit does not move.",
  } as Record<string, string>,
  // Reasons that need no message of the navigator.
  whole_halts: {
    waits_for_route: "Planning the route.",
    paused: "Paused. “Resume” lets it drive on.",
    no_odometry: "Stopped. The drive unit does not report its motion.",
  } as Record<string, string>,
  unsure: "Position unsure. The robot finds its position before it drives.",

  correct: {
    pose: "Set the position",
    pose_hint: "Set the robot's position and heading on the map if they differ from those shown.",
    pose_start: "Set on the map",
    pose_drag:
      "Press where the robot stands and drag in the direction that it faces. Press again to change it.",
    x: "x (m)",
    y: "y (m)",
    theta: "Heading (°)",
    sure: "Accuracy",
    sure_exact: "exactly there (0.2 m)",
    sure_about: "about there (0.5 m)",
    sure_roughly: "somewhere near (2 m)",
    apply: "Apply",
    cancel: "Cancel",
    while_mapping:
      "While the robot maps, its position cannot be set or searched. First press “Stop mapping”, below.",
    search: "Search the whole map",
    search_hint:
      "Discards the position and compares the robot's scans with every place. Let the robot move a few " +
      "metres meanwhile: “Drive by hand” is in the view Send.",
    search_start: "Search",
    mode: "Map",
    mode_hint: "While the robot maps, new scan points change the map. Otherwise the map stays as it is.",
    mode_now: { mapping: "The robot maps now.", localization: "The map stays as it is now." },
    to_mapping: "Start mapping",
    to_localization: "Stop mapping",
    merges: "Merge of maps",
    no_merges: "No merge of two maps is proposed.",
    merge: (robot: string, other: string) => `${robot} seems to be where ${other} has been.`,
    merge_facts: (m: {
      confidence: Maybe;
      stops: number;
      distance_m: Maybe;
      matches: number;
      contradicted: Maybe;
    }) =>
      `Confidence ${percent(m.confidence)}; ${m.matches} of ${m.stops} scan points match over ` +
      `${length(m.distance_m)}; ${percent(m.contradicted)} of the common view contradicts.`,
    accept: "Make them one map",
    refuse: "Keep apart",
    merge_states: {
      open: "open",
      accepted: "accepted: the maps are one",
      refused: "refused",
      withdrawn: "withdrawn: one of the maps no longer exists",
    },
    spectator: "You are watching. Corrections need the operator's link.",
  },

  understand: understand_texts,
  draw: draw_texts,
  time: time_texts,

  panel: {
    title: "Panel",
    prompt: "Number of a goal",
    names: "Goals",
    unknown: (number: string) => `No goal has the number ${number}.`,
    go: "Go",
    erase: "Erase",
    pause: "Pause",
    resume: "Resume",
    cancel: "Cancel",
    return: "Home",
    keypad: "Keypad",
    line: "State",
    no_names: "The map has no rooms or places yet.",
  },

  errors: {
    status: (status: number) => `The service refused the request (HTTP ${status}).`,
    unreachable: "The service cannot be reached.",
    slow: "The service did not answer in time.",
    number: (name: string) => `${name}: enter a number.`,
  },
  done: {
    stop: "The robot is held.",
    goal_held: "The robot is held. It drives there as soon as it is released.",
    release: "The robot may move again.",
    cancel: "The goal is cancelled.",
    resume: "The robot drives on.",
    forget: "The interrupted goal is forgotten.",
    goal: (name: string) => `On the way to ${name}.`,
    goals: (n: number) => `On the way to ${n} goals.`,
    appended: (name: string) => `${name} is added.`,
    explore: "The robot explores.",
    return: "The robot returns home.",
    pose: "The position is set.",
    search: "The whole map is searched.",
    mode: "The mode changes.",
    merge_accept: "The maps are joined.",
    merge_refuse: "The maps stay apart.",
  },
  waiting: {
    sent: "The order is sent. The page waits for the answer …",
    slow: "The service has not answered yet. The page still waits …",
  },
  close: "Close",
};

export type Texts = typeof english;

export const languages: Record<string, Texts> = { en: english, es: spanish };

export const texts: Texts = languages[stored_language(Object.keys(languages))];
