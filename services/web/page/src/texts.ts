// All texts of the page, in English. Another language is another object of this type.
import { draw_texts } from "./draw_texts";
import { area, count, degrees, duration, length, Maybe, percent, point, speed } from "./format";
import { time_texts } from "./time_texts";

export const texts = {
  title: "topogeo",
  language: "en",
  no_robot: "robot",

  states: {
    TRACKING: "Tracking",
    AMBIGUOUS: "Ambiguous",
    SEARCHING: "Searching",
    LOST: "Lost",
    none: "No pose",
    silent: "No pose",
    offline: "Offline",
  },
  reasons: {
    none: "No localizer has reported a pose yet.",
    silent: "No pose has come for over ten seconds; the robot is shown where it was then.",
    offline: "The page does not hear the robot; what it shows is old.",
  },

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
  held: "The robot is held: it does not move until it is released.",
  emergency: "The emergency stop is pressed. Unlock it on the robot, then release it here.",
  release: "Release",
  low_battery: "The battery is low.",
  reconnecting: "Connection lost. Trying again …",
  wrong_token: "The token of this link is not the service's: you can watch, not command.",

  controls: {
    zoom_in: "Zoom in",
    zoom_out: "Zoom out",
    fit: "Show the whole map (F)",
    follow: "Follow the robot (R)",
    layers: "What the map shows",
    theme: "Dark or light",
  },
  layers: {
    rooms: "Rooms in colours",
    names: "Names",
    drawing: "What was drawn",
    graph: "Nodes and branches",
    trail: "Trail of stops",
    loops: "Closed loops",
    scan: "Laser scan",
    local_map: "Voronoi diagram of the last stop",
  },
  empty_map: {
    title: "No map yet",
    text: "The floor appears here as soon as the robot has mapped its first metres.",
    services: (names: string) => `Running services: ${names}.`,
    no_services: "No service of a robot is heard on the network. Start one with “topogeo run”.",
  },

  now: {
    robot: "Robot",
    mode: "Mode",
    modes: { mapping: "Mapping", localization: "Localization, the map stays as it is" },
    position: "Position",
    heading: "Heading",
    precision: "Precision (1 sigma)",
    speed: "Speed",
    sigma: (a: Maybe, b: Maybe, theta: Maybe) => `${length(a)} × ${length(b)}, ${degrees(theta)}`,
    unknown: "unknown",
    health: "At a glance",
    confidence: "Confidence of the pose",
    workers: "Search workers",
    workers_value: (busy: number, slots: number, workers: number) =>
      `${workers} at work, ${busy} of ${slots} slots busy`,
    no_workers: "none at work",
    map: "Map",
    no_map: "none yet",
    map_value: (nodes: Maybe, branches: Maybe, floor: Maybe) =>
      `${area(floor)}, ${count(nodes)} nodes, ${count(branches)} branches`,
    loop: "Last closed loop",
    loop_value: (stops_ago: number) =>
      stops_ago === 0
        ? "at this stop"
        : `${count(stops_ago)} ${stops_ago === 1 ? "stop" : "stops"} ago`,
    no_loop: "none yet",
    battery: "Battery",
    battery_value: (volts: Maybe, low: boolean) =>
      `${typeof volts === "number" ? `${volts.toFixed(1)} V` : "–"}${low ? ", low" : ""}`,
    devices: "Laser and base",
    laser: "Laser",
    base: "Base",
    not_heard: "not heard",
    simulated: "True pose of the simulated robot, in the frame of its world",
    collisions: (n: number) => `${n} collisions`,
    legend: "Legend and keys",
    viewers: (viewers: number, operators: number) =>
      `${viewers} ${viewers === 1 ? "page is" : "pages are"} open, ${operators} may command.`,
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
    fictitious: "Fictitious node: where the view ends",
  },

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
    nearest: "Go to the nearest point that can be reached",
    go: "Go",
    go_all: (n: number) => `Go to all ${n} in this order`,
    append: "Add to the list",
    clear: "Clear",
    remove: (name: string) => `Remove ${name}`,
    list: "Goals in a row",
    list_length: (meters: Maybe, seconds: Maybe) =>
      `Together ${length(meters)}, about ${duration(seconds)}`,
    explore: "Explore",
    explore_title: "Drives everywhere that is not mapped yet",
    return: "Return to base",
    underway: "Under way",
    idle: "The robot has no goal.",
    exploring: "The robot explores by itself.",
    to: (goal: string) => `To ${goal}`,
    rest: (meters: Maybe, seconds: Maybe) => `${length(meters)} left, about ${duration(seconds)}`,
    waiting: (names: string) => `Then: ${names}`,
    progress: "Share of the route that is driven",
    pause: "Pause",
    resume: "Resume",
    cancel: "Cancel",
    spectator: "You are watching. With the operator's link you can send the robot from here.",
    no_navigator: "No navigator is running, so the robot cannot be sent.",
    drive: "Drive by hand",
    drive_hint:
      "Hold a button, or W A S D or the arrow keys. The robot stops when you let go, when the " +
      "page is left or the connection drops.",
    drive_on: "Take the controls",
    drive_off: "Let go of the controls",
    drive_speed: "Speed",
    forward: "Forward",
    backward: "Backward",
    turn_left: "Turn left",
    turn_right: "Turn right",
    drive_idle: "Nobody drives.",
    drive_state: (now: Maybe, free: Maybe) =>
      `${speed(now)}` + (typeof free === "number" ? `, ${length(free)} free ahead` : ""),
  },
  navigator: {
    idle: "Without a goal",
    driving: "Driving",
    relocalizing: "Finding out where it is",
    blocked: "Blocked",
    arrived: "Arrived",
    stopped: "Stopped",
  } as Record<string, string>,
  halts: {
    no_route: "There is no route to the goal.",
    cancelled: "The goal was cancelled.",
    pose_lost: "It is not sure where it is.",
    no_map: "There is no map.",
    outside_map: "It is not on the map.",
    obstacle: "Something that is not on the map is in its way.",
    no_scan: "The laser sends nothing.",
    sonar_silent: "The sonars hear nothing, though something is near.",
    base_not_ready: "The base takes no commands.",
    base_stuck: "The base does not move.",
  } as Record<string, string>,
  // To these the navigator's own message adds nothing.
  whole_halts: {
    waits_for_route: "It waits for a route.",
    paused: "Paused. It drives on after “Resume”.",
    no_odometry: "Stopped. The base sends no odometry.",
  } as Record<string, string>,
  unsure: "It is not sure where it is, and finds that out before it drives.",

  correct: {
    pose: "Set the pose",
    pose_hint: "When the robot is somewhere else than shown: set its place and heading on the map.",
    pose_start: "Set on the map",
    pose_drag: "Press where the robot stands, drag to where it looks. Press again to change it.",
    x: "x (m)",
    y: "y (m)",
    theta: "Heading (°)",
    sure: "How sure",
    sure_exact: "exactly there (0.2 m)",
    sure_about: "about there (0.5 m)",
    sure_roughly: "somewhere near (2 m)",
    apply: "Apply",
    cancel: "Cancel",
    while_mapping:
      "While the robot maps, its pose can neither be set nor searched. First press “Leave the map " +
      "as it is”, below.",
    search: "Search the whole map",
    search_hint:
      "Forgets the pose and compares what the robot sees with every place. Let it move a few " +
      "metres meanwhile: “Drive by hand” is in the view Send.",
    search_start: "Search",
    mode: "Map",
    mode_hint: "While mapping, new stops change the map. Localization leaves it as it is.",
    mode_now: { mapping: "The robot maps now.", localization: "The map stays as it is now." },
    to_mapping: "Map from now on",
    to_localization: "Leave the map as it is",
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
      `Confidence ${percent(m.confidence)}; ${m.matches} of ${m.stops} stops match over ` +
      `${length(m.distance_m)}; ${percent(m.contradicted)} contradicts.`,
    accept: "Make them one map",
    refuse: "Keep apart",
    merge_states: {
      open: "open",
      accepted: "accepted: the maps are one",
      refused: "refused",
      withdrawn: "withdrawn: a map is gone",
    },
    spectator: "You are watching. Corrections need the operator's link.",
  },

  understand: {
    why: "Why this state",
    loops: "Loops",
    loops_hint: "Places to which the robot may have come back. Choose one to see both stops.",
    loops_count: (accepted: number, rejected: number) =>
      `${count(accepted)} accepted, ${count(rejected)} rejected`,
    no_loops: "No loop has been decided yet: the robot has not come back to an earlier place.",
    filters: { all: "All", accepted: "Accepted", rejected: "Rejected" },
    filter_label: "Which loops",
    loop: (later: number, earlier: number) => `Stop ${later} at stop ${earlier}`,
    outcomes: {
      accepted: "Accepted",
      gate: "Match not accepted",
      unconfirmed: "Not confirmed",
      no_closing: "Does not fit the way round",
      outvoted: "Outvoted later",
    },
    sources: {
      prediction: "Compared because the poses predict it.",
      place: "Compared because it looks like that place.",
      window: "Compared because it looks like that place, as a whole.",
    } as Record<string, string>,
    // By what the localizer says of a loop.
    meanings: {
      "nothing in common": "The two stops hardly see the same part of the floor.",
      "little overlap": "The two stops see too little of the same floor.",
      "few inliers": "Too few points of the later stop lie on walls of the earlier one.",
      doubtful: "No measure of the match fails alone; together they leave too much doubt.",
      "far from the prediction": "The match lies farther from where the poses put it than they allow.",
      "second solution": "It fits in another way nearly as well.",
      unconfirmed: "It would move the robot far, and nothing agrees with it so far.",
      "no consistent closing": "No poses along the way round fit what was seen on it.",
      outvoted: "It was accepted at first; the rest of the map contradicted it.",
    } as Record<string, string>,
    loop_facts: (fitness: Maybe, probability: Maybe, moved: Maybe, turned: Maybe) =>
      `Fitness ${percent(fitness)}, probability ${percent(probability)}; moves the stop by ` +
      `${length(moved)}, ${degrees(turned)}.`,
    loading_maps: "Fetching both local maps …",
    key_earlier: "earlier stop",
    key_later: "later stop, as matched",
    key_predicted: "later stop, as the poses had put it",
    fitness: "Fitness",
    probability: "Probability",
    share: (value: Maybe) => (typeof value === "number" ? percent(value) : "not kept"),
    overlap: "Of what the later stop saw, in the earlier one's view",
    near: "Of that within 10 cm of its walls",
    moved: "Match and poses differ by",
    none: "nothing",
    moved_value: (meters: Maybe, turn: Maybe) =>
      typeof meters === "number" ? `${length(meters)}, ${degrees(turn)}` : "not kept",
    corrected: "Moves the stop by",
    search: "Search",
    search_hint:
      "What the localizer compares at the moment: the rectangle that it searches, the ellipse where " +
      "the poses expect the robot (2 sigma), and what it found.",
    no_search: "No search was heard yet.",
    search_map: (places: number, running: boolean) =>
      running && places === 0
        ? "The whole map is searched …"
        : `Search of the whole map: ${places} ${places === 1 ? "place fits" : "places fit"} best.`,
    search_matches: (tasks: number, accepted: number, running: boolean) =>
      running
        ? `${tasks} ${tasks === 1 ? "match is" : "matches are"} worked on …`
        : `${tasks} ${tasks === 1 ? "match" : "matches"}, ${accepted} accepted.`,
    search_best: (fitness: number, old: boolean) =>
      `Best fitness ${fitness.toFixed(2)}.` +
      (old ? " Nothing is searched until the robot has moved on a little." : ""),
    more: (n: number) => `${count(n)} earlier ones are not listed.`,
    workers: "Search workers",
    no_workers: "No worker is heard: the localizer searches in its own process.",
    load: "Load",
    worker_facts: (slots: number, done: number, rate: string, failures: number) =>
      `${slots} ${slots === 1 ? "slot" : "slots"}, ${count(done)} tasks done, ${rate}, ` +
      `${count(failures)} failed`,
    draining: "finishes and goes",
    services: "Services",
    no_services: "No service is heard.",
    service_states: {
      starting: "starting",
      waiting: "waiting",
      running: "running",
      finished: "finished",
      failed: "failed",
      stopped: "stopped",
      lost: "lost: no sign of life",
    } as Record<string, string>,
    waits_for: (what: string) => `Waits for ${what}.`,
    input: (topic: string, rate: string) => `${topic} ${rate}`,
    faults: (n: number) => `${count(n)} ${n === 1 ? "fault" : "faults"}`,
    last_error: (text: string) => `Last: ${text}`,
    events: "Events",
    no_events: "Nothing has happened yet.",
    levels: { info: "Info", warning: "Warning", error: "Error" },
  },

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
    return: "Base",
    keypad: "Keypad",
    line: "State",
    no_names: "The map has no rooms or places yet.",
  },

  errors: {
    status: (status: number) => `The service refused this (HTTP ${status}).`,
    unreachable: "The service cannot be reached.",
    slow: "The service did not answer in time.",
    number: (name: string) => `${name}: enter a number.`,
  },
  done: {
    stop: "The robot is stopped and held.",
    release: "The robot may move again.",
    goal: (name: string) => `On the way to ${name}.`,
    goals: (n: number) => `On the way to ${n} goals.`,
    appended: (name: string) => `${name} is added.`,
    explore: "The robot explores.",
    return: "The robot returns to its base.",
    pose: "The pose is set.",
    search: "The whole map is searched.",
    mode: "The mode changes.",
    merge_accept: "The maps become one.",
    merge_refuse: "The maps stay apart.",
  },
  close: "Close",
};
