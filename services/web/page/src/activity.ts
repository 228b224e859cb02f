// A few words for the header: what the robot does now, or what it waits for.
import { Channels } from "./channels";
import { Goals, Navigator } from "./protocol";
import { Rights } from "./rights";
import {
  hand_is_stopped,
  has_foreign_goal,
  is_paused,
  is_silent,
  rest_of_wait,
  robot_is_absent,
} from "./robot_state";
import { texts } from "./texts";

const words = texts.activity;

export interface Activity {
  text: string;
  level: "plain" | "moves" | "waits" | "held";
}

/** Null while that is unknown: without a connection or a robot. */
export function activity(channels: Channels, rights: Rights): Activity | null {
  if (!rights.connected || robot_is_absent(channels)) return null;
  const base = channels.value("base");
  const goals = channels.value("goals");
  const by = channels.value("controls")?.stopped_by ?? "";
  if (base?.state === "emergency_stop") return { text: words.emergency, level: "held" };
  if (base?.state === "halted" || hand_is_stopped(channels)) {
    return { text: words.held(by), level: "held" };
  }
  if (base && words.base[base.state]) return { text: words.base[base.state], level: "held" };
  if (channels.value("drive")?.held) {
    return { text: words.by_hand(channels.value("controls")?.holder?.name ?? ""), level: "moves" };
  }
  const navigator = channels.value("navigator");
  if (!navigator) return { text: words.no_navigator, level: "plain" };
  if (is_silent(channels, "navigator")) return null;
  const wait_s = rest_of_wait(channels);
  if (wait_s > 0 && goals?.current && !is_paused(channels)) {
    return { text: texts.missions.stays(goals.current.text, wait_s), level: "waits" };
  }
  return on_the_way(navigator, goals, has_foreign_goal(channels), is_paused(channels));
}

function on_the_way(
  navigator: Navigator,
  goals: Goals | null,
  foreign: boolean,
  paused: boolean,
): Activity {
  const goal = goals?.current?.text ?? (foreign ? texts.send.to_foreign : "");
  const exploring = goals?.exploring ?? false;
  const to = exploring ? "" : goal;
  if (paused && (to || exploring)) return { text: words.paused(to), level: "waits" };
  switch (navigator.state) {
    case "driving": {
      const { rest_m, rest_s } = navigator;
      if (exploring) return { text: words.exploring, level: "moves" };
      // It corrects its place at the goal, or only looks.
      if ((rest_m ?? 0) < 0.05) return { text: words.at_goal(to), level: "moves" };
      return { text: words.driving(to, rest_m, rest_s), level: "moves" };
    }
    case "relocalizing":
      return { text: words.finding, level: "waits" };
    case "blocked":
      return { text: words.blocked(to), level: "waits" };
    case "stopped":
      if (navigator.reason === "waits_for_route") return { text: words.planning(to), level: "waits" };
      if (navigator.reason === "cancelled" || (!to && !exploring)) break;
      return { text: words.waiting[navigator.reason] ?? words.stopped, level: "waits" };
    case "arrived":
      if (exploring) return { text: words.exploring, level: "moves" };
      return { text: words.arrived, level: "plain" };
  }
  return { text: exploring ? words.exploring : words.idle, level: exploring ? "moves" : "plain" };
}
