// The robot's state in a word and a sentence.
import { Channels } from "./channels";
import { Rights } from "./app";
import { Pose, ValueName } from "./protocol";
import { texts } from "./texts";

export type StateName = keyof typeof texts.states;

/** Poses come with each scan; without one for so long nobody knows where the robot is now. */
const kSilence_ms = 10_000;

/** Each of these values comes at least twice a second. */
const kFresh_ms = 2500;

/** How often it is seen whether poses still come, which no message says. */
export const kSilenceTick_ms = 1000;

/** What runs without a robot, too: beside a stored map, or on the machine of the operator. */
const kWithoutRobot = new Set(["web", "map_store", "planner", "ga_worker"]);

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
  return named(pose.state, with_age(channels, "pose", pose.reason));
}

/** A text about a value, and since when the value is not new any more, where it is old. */
export function with_age(channels: Channels, name: ValueName, text: string): string {
  const age_ms = channels.age_ms(name) ?? 0;
  return age_ms < kFresh_ms ? text : texts.aged(text, age_ms / 1000);
}

/** Whether a value is so old that it says nothing about now. */
export function is_silent(channels: Channels, name: ValueName): boolean {
  return (channels.age_ms(name) ?? 0) > kSilence_ms;
}

/** The pose where it is the robot's of now; null where that is not known. */
export function pose_of_now(channels: Channels, rights: Rights): Pose | null {
  const { name } = robot_state(channels, rights);
  return name === "offline" || name === "silent" ? null : channels.value("pose");
}

function robot_is_absent(channels: Channels): boolean {
  const live = [...channels.table("services").values()].filter(({ state }) => state !== "lost");
  return live.length > 0 && live.every(({ service }) => kWithoutRobot.has(service));
}

/** Why the base does not move until somebody releases it; null when it may. */
export function held_text(channels: Channels): string | null {
  const base = channels.value("base");
  if (base?.state === "halted") return texts.held;
  if (base?.state === "emergency_stop") return texts.emergency;
  return null;
}

/** Where a robot drives as soon as it may move again, as a text; null without a goal. */
export function pending_goal(channels: Channels): string | null {
  const goals = channels.value("goals");
  if (goals?.exploring) return texts.send.to_explore;
  if (goals?.current) return goals.current.text;
  return has_foreign_goal(channels) ? texts.send.to_foreign : null;
}

/** The navigator has a goal that was not sent from here, or before the service began anew. */
export function has_foreign_goal(channels: Channels): boolean {
  const navigator = channels.value("navigator");
  const goals = channels.value("goals");
  if (!navigator || goals?.current || goals?.exploring) return false;
  return navigator.state !== "idle" && navigator.state !== "arrived";
}

/** What the navigator does, as a sentence. */
export function navigator_text(channels: Channels, rights: Rights): string {
  if (!rights.connected) return texts.send.not_heard;
  const navigator = channels.value("navigator");
  if (!navigator) return texts.send.no_navigator;
  const state = texts.navigator[navigator.state] ?? navigator.state;
  // These messages say the state themselves.
  const says_state = navigator.state === "idle" || navigator.state === "arrived";
  if (says_state && navigator.message) return sentence(navigator.message);
  // How far it is stands beside it.
  if (navigator.state === "driving" && navigator.message.startsWith("drives")) return `${state}.`;
  const halted = navigator.state === "stopped" || navigator.state === "blocked";
  const halt = halted ? texts.halts[navigator.reason] : undefined;
  const whole = halted ? texts.whole_halts[navigator.reason] : undefined;
  if (whole) return whole;
  if (navigator.state === "relocalizing" && /does not track/.test(navigator.message)) {
    return texts.unsure;
  }
  // A base that takes no commands says so itself, and why.
  const repeated = halt && sentence(navigator.message).startsWith(halt.slice(0, -1));
  const parts = [halt && !repeated ? `${state}. ${halt}` : `${state}.`];
  if (navigator.message) parts.push(sentence(navigator.message));
  return parts.join(" ");
}

/** A message of a service with a capital letter and a full stop. */
export function sentence(text: string): string {
  if (text === "") return "";
  const capital = text[0].toUpperCase() + text.slice(1);
  return /[.!?…]$/.test(capital) ? capital : `${capital}.`;
}
