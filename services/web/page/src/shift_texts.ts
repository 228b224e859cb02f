// Texts of alarms, missions and the report of a drive; texts.ts has all others.
import { area, counted, duration, length, Maybe } from "./format";

export const alarm_texts = {
  title: "Alarms",
  none: "There was no alarm.",
  acknowledge: "Acknowledge",
  acknowledge_all: (n: number) => `Acknowledge all ${n}`,
  acknowledge_one: (text: string) => `Acknowledge: ${text}`,
  all: (n: number) => `All ${n}`,
  show: (n: number) => `Show all ${n} alarms`,
  repeated: (times: number, last: string) => `${times} times, last at ${last}`,
  acknowledged: (who: string, when: string) => `Acknowledged by ${who} at ${when}`,
  done: "The alarm is acknowledged.",
  sources: { base: "drive unit", laser: "laser", navigator: "navigator", localizer: "localizer" } as Record<string, string>,
};

export const mission_texts = {
  title: "Missions",
  none: "No mission is saved yet. Choose goals, then save them here for another day.",
  name: "Name of the mission",
  save: "Save these goals",
  goals: (n: number) => counted(n, "goal", "goals"),
  remove: (name: string) => `Remove the mission ${name}`,
  wait: "stay (s)",
  wait_at: (name: string) => `Seconds to stay at ${name}`,
  repeat: "Drive this list",
  rounds: (n: number) => (n === 0 ? "until it is cancelled" : n === 1 ? "once" : `${n} times`),
  earlier: (name: string) => `Move ${name} one up`,
  later: (name: string) => `Move ${name} one down`,
  stays: (goal: string, seconds: Maybe) => `Stays at ${goal} (${duration(seconds)} left)`,
  drive_on: "Drive on now",
  round: (now: number, of: number) =>
    of === 0 ? `Round ${now}, until it is cancelled` : `Round ${now} of ${of}`,
};

export const report_texts = {
  title: "Report of the drive",
  hint: "One page to print or to send: map, distance, time, goals, alarms and events.",
  make: "Save the report",
  making: "Making the report …",
  made_at: (when: string) => `Made on ${when}`,
  from_to: "From, to",
  driven: "Driven",
  distance: (meters: Maybe, seconds: Maybe) => `${length(meters)} in ${duration(seconds)} without the pauses`,
  points: "Scan points",
  map: "Map",
  map_value: (floor: Maybe, rooms: number) => `${area(floor)}, ${counted(rooms, "room", "rooms")}`,
  loops: "Loops",
  loops_value: (accepted: number, rejected: number) => `${accepted} accepted, ${rejected} rejected`,
  held: "Stop was pressed",
  times: (n: number) => (n === 1 ? "once" : `${n} times`),
  reached: "Goals reached",
  reached_value: (reached: number, sent: number) => `${reached} of ${sent}`,
  goals: "Goals",
  alarms: "Alarms",
  events: "Warnings and errors",
  nothing: "None.",
  more: (n: number) => `${n} earlier ones are not listed.`,
  picture: "Map of the floor",
};
