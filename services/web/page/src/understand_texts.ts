// Texts of the view Understand; texts.ts has all others.
import { count, degrees, length, Maybe, percent } from "./format";

export const understand_texts = {
  why: "Why this state",
  loops: "Loops",
  loops_hint: "Places to which the robot may have come back. Choose one to see both scan points.",
  loops_kept: (accepted: number) =>
    `${count(accepted)} accepted. Nothing is kept about rejected ones.`,
  loops_count: (accepted: number, rejected: number) =>
    `${count(accepted)} accepted, ${count(rejected)} rejected`,
  no_loops: "The robot has not come back to an earlier place yet, so there is no loop.",
  filters: { all: "All", accepted: "Accepted", rejected: "Rejected" },
  filter_label: "Which loops",
  loop: (later: number, earlier: number) => `Scan point ${later} at scan point ${earlier}`,
  outcomes: {
    accepted: "Accepted",
    gate: "Match not accepted",
    unconfirmed: "Not confirmed",
    no_closing: "Does not fit the loop",
    outvoted: "Outvoted later",
  },
  sources: {
    prediction: "Compared because the positions predict this loop.",
    place: "Compared because the last metres look like that place.",
    window: "Compared because the last metres, matched as a whole, look like that place.",
  } as Record<string, string>,
  accepted: "Accepted.",
  not_kept: "No evidence of it is kept with the map.",
  // Keyed by the localizer's explanation of a loop.
  meanings: {
    "nothing in common": "The two scan points hardly see the same part of the floor.",
    "little overlap": "The two scan points see too little of the same floor.",
    "few inliers": "Too few points of the later scan lie on walls of the earlier one.",
    doubtful: "No measure of the match fails alone, but together they leave too much doubt.",
    "far from the prediction": "The match lies farther from the predicted position than its uncertainty allows.",
    "second solution": "Another solution of the match fits nearly as well.",
    unconfirmed: "The loop would move the robot far, and no other loop agrees with it yet.",
    "no consistent closing": "No positions along the loop fit what was seen on it.",
    outvoted: "The loop was accepted at first, but the rest of the map contradicted it.",
  } as Record<string, string>,
  loop_facts: (
    fitness: Maybe,
    probability: Maybe,
    moved: Maybe,
    turned: Maybe,
    accepted: boolean,
  ) =>
    `Fitness ${percent(fitness)}, estimated ${percent(probability)} probable; ` +
    `${accepted ? "moves" : "would move"} the scan point by ${length(moved)}, ${degrees(turned)}.`,
  loading_maps: "Fetching both local maps …",
  key_earlier: "earlier scan point",
  key_later: "later scan point, as matched",
  key_predicted: "later scan point, as predicted",
  fitness: "Fitness",
  probability: "Estimated probability that it is right",
  probable_but_rejected:
    "The match is probably right. The reason above rejects the loop all the same, because a wrong loop " +
    "bends the map.",
  share: (value: Maybe) => (typeof value === "number" ? percent(value) : "not kept"),
  overlap: "Part of the later view in the earlier one",
  near: "Part of the common view within 10 cm of the earlier walls",
  moved: "Match and prediction differ by",
  none: "nothing",
  moved_value: (meters: Maybe, turn: Maybe) =>
    typeof meters === "number" ? `${length(meters)}, ${degrees(turn)}` : "not kept",
  corrected: "Shift of the scan point by the loop",
  search: "Search",
  search_hint:
    "Shows the present search: the rectangle that is searched, the ellipse where the " +
    "robot is expected (2 sigma), and the results.",
  no_search: "There was no search yet.",
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
    (old ? " The next search begins when the robot has moved on a little." : ""),
  more: (n: number) => `${count(n)} earlier ones are not listed.`,
  workers: "Search workers",
  no_workers: "No worker is connected: the localizer searches by itself.",
  load: "Load",
  worker_facts: (slots: number, done: number, rate: string, failures: number) =>
    `${slots} ${slots === 1 ? "slot" : "slots"}, ${count(done)} tasks done, ${rate}, ` +
    `${count(failures)} failed`,
  draining: "finishes its tasks, then ends",
  services: "Services",
  no_services: "No service is connected.",
  service_states: {
    starting: "starting",
    waiting: "waiting",
    running: "running",
    finished: "finished",
    failed: "failed",
    stopped: "stopped",
    lost: "lost: reports nothing",
  } as Record<string, string>,
  waits_for: (what: string) => `Waits for ${what}.`,
  technical: "Technical details",
  input: (topic: string, rate: string) => `${topic} ${rate}`,
  faults: (n: number) => `${count(n)} ${n === 1 ? "fault" : "faults"}`,
  last_error: (text: string) => `Last: ${text}`,
  events: "Events",
  no_events: "Nothing has happened yet.",
  no_such_events: "There is no such event.",
  event_filters: { all: "All", trouble: "Warnings and errors", errors: "Errors" },
  event_filter_label: "Which events",
  save_events: "Save as a file",
  levels: { info: "Info", warning: "Warning", error: "Error" },
};
