// Texts of the header and its banners; texts.ts has all others.
import { duration, length, Maybe } from "./format";

export const activity_texts = {
  idle: "Idle",
  arrived: "Arrived",
  emergency: "Emergency stop",
  held: (by: string) => (by ? `Held by ${by}` : "Held"),
  by_hand: (by: string) => (by ? `Driven by hand by ${by}` : "Driven by hand"),
  driving: (goal: string, meters: Maybe, seconds: Maybe) =>
    `Driving${goal ? ` to ${goal}` : ""}` +
    (typeof meters === "number" ? ` (${length(meters)}, ${duration(seconds)})` : ""),
  at_goal: (goal: string) => `At ${goal || "the goal"}, checking its position`,
  exploring: "Exploring",
  paused: (goal: string) => (goal ? `Paused on the way to ${goal}` : "Paused"),
  planning: (goal: string) => `Planning the route${goal ? ` to ${goal}` : ""}`,
  finding: "Finding its position",
  blocked: (goal: string) => `Waiting for a free path${goal ? ` to ${goal}` : ""}`,
  stopped: "Waiting",
  no_navigator: "Not ready to drive",
  base: {
    offline: "Drive unit not connected",
    starting: "Drive unit is starting",
    watchdog_expired: "Drive unit stopped: no orders arrived",
    bumped: "Bumped into something",
    joystick: "Moved by its joystick",
    motors_off: "Motors off",
  } as Record<string, string>,
  waiting: {
    no_route: "Waiting: no route to the goal",
    pose_lost: "Waiting: position lost",
    no_map: "Waiting for a map",
    outside_map: "Waiting: not on the map",
    obstacle: "Waiting: something is in the way",
    no_scan: "Waiting for the laser",
    sonar_silent: "Waiting for the sonars",
    no_odometry: "Waiting for the drive unit",
    base_not_ready: "Waiting for the drive unit",
    base_stuck: "Stuck: the drive unit does not move",
  } as Record<string, string>,
};

export const controls_texts = {
  other: (name: string) => `${name} has the controls. You can watch, and stop the robot.`,
  waiting: (name: string) => `You asked ${name} for the controls …`,
  asks: (name: string) => `${name} asks for the controls.`,
  ask: "Ask for them",
  take: "Take over",
  give: "Give them",
  keep: "Keep them",
  got: "You have the controls now.",
  lost: (name: string) => `${name} has the controls now.`,
  kept: (name: string) => `${name} keeps the controls.`,
  title: "Operators",
  holder: "Controls",
  nobody: "free: the next order takes them",
  mine: "yours",
  your_name: "Your name, for other operators",
  no_name: "an operator",
  let_go: "Give up the controls",
  language: "Language",
  language_names: { en: "English", es: "Español" } as Record<string, string>,
};
