// The robot's state as a word and a sentence.
import { Channels } from "./channels";
import { reason } from "./reasons";
import { Pose, ValueName } from "./protocol";
import { Rights } from "./rights";
import { texts } from "./texts";

export type StateName = keyof typeof texts.states;

/** Poses arrive with each scan; without one for this long the robot's place is unknown. */
const silenceMs = 10_000;

/** Each of these values arrives at least twice a second. */
const freshMs = 2500;

/** Interval for checking whether poses still arrive, because no message reports that. */
export const silenceTickMs = 1000;

/** Services that also run without a robot: for a stored map, or on the operator's machine. */
const withoutRobot = new Set(["web", "map_store", "planner", "ga_worker"]);

export interface RobotState {
  name: StateName;
  word: string;
  reason: string;
}

export function robot_state(channels: Channels, rights: Rights): RobotState {
  const named = (name: StateName, reason: string) => ({ name, word: texts.states[name], reason });
  if (!rights.connected) return named("offline", texts.reasons.offline);
  const pose = channels.value("pose");
  if (!pose) {
    const name = robot_is_absent(channels) ? "absent" : "none";
    return named(name, texts.reasons[name]);
  }
  if (is_silent(channels, "pose")) return named("silent", texts.reasons.silent);
  if (is_misplaced(channels)) return named("misplaced", texts.reasons.misplaced);
  return named(pose.state, with_age(channels, "pose", texts.reasons[pose.state] ?? pose.reason));
}

/** Whether the laser contradicts a position that the localizer still accepts, as one that was set 20 m off. */
export function is_misplaced(channels: Channels): boolean {
  const state = channels.value("pose")?.state;
  const located = state === "TRACKING" || state === "AMBIGUOUS";
  return located && channels.value("scan")?.fits === false;
}

/** A text about a value, with the value's age if it is old. */
export function with_age(channels: Channels, name: ValueName, text: string): string {
  const age_ms = channels.age_ms(name) ?? 0;
  return age_ms < freshMs ? text : texts.aged(text, age_ms / 1000);
}

/** Whether a value is too old to describe the present. */
export function is_silent(channels: Channels, name: ValueName): boolean {
  return (channels.age_ms(name) ?? 0) > silenceMs;
}

/** The current pose of the robot; null if unknown. */
export function pose_of_now(channels: Channels, rights: Rights): Pose | null {
  const { name } = robot_state(channels, rights);
  return name === "offline" || name === "silent" ? null : channels.value("pose");
}

/** Whether services run, but none of a robot. */
export function robot_is_absent(channels: Channels): boolean {
  const live = [...channels.table("services").values()].filter(({ state }) => state !== "lost");
  return live.length > 0 && live.every(({ service }) => withoutRobot.has(service));
}

/** Whether there has been no robot since the page was opened: only a map is shown. */
export function is_map_alone(channels: Channels): boolean {
  const heard = (["pose", "base", "navigator", "laser"] as const).some((name) => channels.value(name));
  return robot_is_absent(channels) && !heard;
}

/** Why the base does not move until it is released; null if it may move. */
export function held_text(channels: Channels): string | null {
  const base = channels.value("base");
  if (base?.state === "halted") return texts.held;
  if (base?.state === "emergency_stop") return texts.emergency;
  return null;
}

/** Whether a stop holds that no base reports, as with a base of ROS: service and navigator keep it. */
export function hand_is_stopped(channels: Channels): boolean {
  return !channels.value("base") && channels.value("drive")?.stopped === true;
}

/** Goal to which the robot drives as soon as it may move again, as text; null without a goal. */
export function pending_goal(channels: Channels): string | null {
  const goals = channels.value("goals");
  if (goals?.exploring) return texts.send.to_explore;
  if (goals?.current) return goals.current.text;
  return has_foreign_goal(channels) ? texts.send.to_foreign : null;
}

/** Goal, list or exploration that a stop has interrupted, as text; null if there is none. */
export function interrupted_goal(channels: Channels): string | null {
  const interrupted = channels.value("goals")?.interrupted;
  if (!interrupted) return null;
  if (interrupted.exploring) return texts.send.to_explore;
  return texts.and_more(interrupted.text, interrupted.waiting);
}

/** Whether the navigator has a goal of another client, or from before a restart of the service. */
export function has_foreign_goal(channels: Channels): boolean {
  const navigator = channels.value("navigator");
  const goals = channels.value("goals");
  if (!navigator || goals?.current || goals?.exploring) return false;
  return navigator.state !== "idle" && navigator.state !== "arrived";
}

/** Whether the robot waits for a resume, also with an ordered pause that nothing has confirmed yet. */
export function is_paused(channels: Channels): boolean {
  return channels.value("navigator")?.reason === "paused" || channels.value("goals")?.pausing === true;
}

/** Seconds that the robot still stays at its goal; 0: it does not. */
export function rest_of_wait(channels: Channels): number {
  const waits_s = channels.value("goals")?.waits_s ?? 0;
  return Math.max(0, waits_s - (channels.age_ms("goals") ?? 0) / 1000);
}

// Reasons of a base, or of a navigator without one, that an operator holds.
const holds = /: (held|stopped by an operator)/;

/** The navigator's activity as a sentence. */
export function navigator_text(channels: Channels, rights: Rights): string {
  if (!rights.connected) return texts.send.not_heard;
  const navigator = channels.value("navigator");
  if (!navigator) return texts.send.no_navigator;
  const state = texts.navigator[navigator.state] ?? navigator.state;
  // These messages name the state themselves.
  const says_state = navigator.state === "idle" || navigator.state === "arrived";
  if (says_state && navigator.message) return reason(navigator.message);
  // The distance is displayed next to it.
  if (navigator.state === "driving" && navigator.message.startsWith("drives")) return `${state}.`;
  const halted = navigator.state === "stopped" || navigator.state === "blocked";
  const halt = halted ? texts.halts[navigator.reason] : undefined;
  const whole = halted ? texts.whole_halts[navigator.reason] : undefined;
  if (whole) return whole;
  if (navigator.reason === "base_not_ready" && holds.test(navigator.message)) return texts.held;
  if (navigator.state === "relocalizing" && /does not track/.test(navigator.message)) {
    return texts.unsure;
  }
  // A base that takes no commands reports that itself, with the reason.
  const repeated = halt && reason(navigator.message).startsWith(halt.slice(0, -1));
  const parts = [halt && !repeated ? `${state}. ${halt}` : `${state}.`];
  if (navigator.message) parts.push(reason(navigator.message));
  return parts.join(" ");
}
