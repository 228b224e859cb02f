// Now: the state of the robot and its map.
import { App, ViewPart } from "../app";
import { Channels } from "../channels";
import * as format from "../format";
import { reason } from "../reasons";
import { ellipse_of } from "../map/robot_layer";
import { Pose, ValueName } from "../protocol";
import { is_silent, silenceTickMs, pose_of_now, robot_is_absent, with_age } from "../robot_state";
import { texts } from "../texts";
import { Bar, Facts, Level } from "../ui/bar";
import { h, set_text, show } from "../ui/dom";
import { once_a_frame } from "../ui/schedule";
import { folded, section } from "../ui/section";
import { legend } from "./legend";
import { Operators } from "./operators";

const staleLoopStops = 60; // number of stops after which the bar of the last loop is empty

const words = texts.now;

function old(channels: Channels, name: ValueName): Level {
  return is_silent(channels, name) ? "bad" : "plain";
}

export class NowView implements ViewPart {
  readonly element: HTMLElement;
  private readonly facts = new Facts();
  private readonly devices = new Facts();
  private readonly truth = new Facts();
  private readonly map = new Facts();
  private readonly truth_section: HTMLElement;
  private readonly robot_section: HTMLElement;
  private readonly devices_section: HTMLElement;
  private readonly bars_section: HTMLElement;
  private readonly viewers = h("p", { class: "quiet" });
  private readonly operators: Operators;
  private readonly confidence = new Bar(words.confidence);
  private readonly workers = new Bar(words.workers);
  private readonly loop = new Bar(words.loop);
  private readonly battery = new Bar(words.battery);
  private visible = false;

  constructor(private readonly app: App) {
    this.operators = new Operators(app);
    this.truth_section = section(
      words.simulated,
      this.truth.element,
      h("p", { class: "quiet" }, words.simulated_hint),
    );
    const bars = [this.confidence, this.workers, this.loop, this.battery];
    this.robot_section = section(words.robot, this.facts.element);
    this.devices_section = section(words.devices, this.devices.element);
    this.bars_section = h("div", { class: "bars" }, ...bars.map((bar) => bar.element));
    const picture = legend(() => app.theme.palette);
    app.theme.on_change(() => picture.redraw());
    this.element = h(
      "div",
      { class: "view" },
      section(words.health, this.bars_section, this.map.element),
      this.robot_section,
      this.devices_section,
      this.truth_section,
      folded(words.legend, false, picture.element),
      this.operators.element,
      this.viewers,
    );
    const update = once_a_frame(() => this.update());
    const { channels } = app;
    channels.on_value(["pose", "navigator", "base", "laser", "truth", "viewers", "controls"], update);
    channels.on_table("workers", update);
    channels.on_table("loops", update);
    channels.on_table("trail", update);
    channels.on_table("graph", update);
    channels.on_table("rooms", update);
    app.rights.on_change(update);
    setInterval(update, silenceTickMs);
  }

  shown(visible: boolean): void {
    this.visible = visible;
    if (visible) this.update();
  }

  private update(): void {
    if (!this.visible) return;
    const { channels } = this.app;
    const pose = channels.value("pose");
    // A map that is shown alone has nothing to say of a robot.
    const robot = !robot_is_absent(channels);
    for (const part of [this.robot_section, this.devices_section, this.bars_section]) {
      show(part, robot);
    }
    this.show_pose(pose);
    this.show_bars(pose_of_now(channels, this.app.rights));
    const laser = channels.value("laser");
    const because = (why: string) => (why ? `. ${reason(why)}` : "");
    this.show_device(
      words.laser,
      "laser",
      laser &&
        `${words.laser_states[laser.state] ?? laser.state}, ` +
          `${format.rate(laser.scans_per_s)}${because(laser.reason)}`,
    );
    const base = channels.value("base");
    this.show_device(
      words.base,
      "base",
      base && (words.base_states[base.state] ?? base.state) + because(base.reason),
    );
    const truth = channels.value("truth");
    show(this.truth_section, truth !== null);
    if (truth) {
      const at = format.point(truth.x_m, truth.y_m);
      this.truth.set(words.in_world, `${at}, ${format.degrees(truth.theta_rad)}`);
      this.truth.set("", words.collisions(truth.collisions));
    }
    this.operators.update();
    const viewers = channels.value("viewers");
    const operators = robot ? viewers?.operators : undefined;
    set_text(this.viewers, viewers ? words.viewers(viewers.viewers, operators) : "");
  }

  private show_pose(pose: Pose | null): void {
    const located = pose && pose.state !== "SEARCHING" && pose.state !== "LOST" ? pose : null;
    const ellipse = located ? ellipse_of(located.covariance) : null;
    const variance = located?.covariance[8];
    this.facts.set(words.mode, pose ? words.modes[pose.mode] : words.unknown);
    this.facts.set(
      words.position,
      located
        ? with_age(this.app.channels, "pose", format.point(located.x_m, located.y_m))
        : words.unknown,
      old(this.app.channels, "pose"),
    );
    this.facts.set(words.heading, located ? format.degrees(located.theta_rad) : words.unknown);
    this.facts.set(
      words.precision,
      ellipse
        ? words.sigma(
            ellipse[0],
            ellipse[1],
            typeof variance === "number" ? Math.sqrt(variance) : null,
          )
        : words.unknown,
    );
    const { channels } = this.app;
    const speed = format.speed(channels.value("navigator")?.linear_mps);
    this.facts.set(words.speed, with_age(channels, "navigator", speed), old(channels, "navigator"));
  }

  private show_device(name: string, channel: ValueName, text: string | null): void {
    const { channels } = this.app;
    const shown = text === null ? words.not_heard : with_age(channels, channel, text);
    this.devices.set(name, shown, old(channels, channel));
  }

  private show_bars(pose: Pose | null): void {
    const { channels } = this.app;
    const confidence = pose?.confidence ?? 0;
    const level: Level = confidence > 0.9 ? "good" : confidence > 0.5 ? "fair" : "bad";
    this.confidence.set(confidence, pose ? format.percent(pose.confidence) : words.unknown, level);

    let [slots, busy] = [0, 0];
    const workers = channels.table("workers");
    for (const worker of workers.values()) {
      slots += worker.slots;
      busy += worker.in_hand;
    }
    this.workers.set(
      slots > 0 ? busy / slots : 0,
      workers.size > 0 ? words.workers_value(busy, slots, workers.size) : words.no_workers,
    );

    let floor = 0;
    for (const room of channels.table("rooms").values()) floor += room.area_m2;
    const graph = channels.table("graph").get("map");
    const squares = channels.table("tiles").size;
    this.map.set(
      words.map,
      graph || squares > 0 ? words.map_value(graph?.nodes, graph?.branches, floor) : words.no_map,
    );

    let last = -1;
    for (const loop of channels.table("loops").values()) {
      if (loop.accepted) last = Math.max(last, loop.step);
    }
    const ago = Math.max(0, this.app.map.scene.trail.size() - 1 - last);
    this.loop.set(
      last < 0 ? 0 : 1 - ago / staleLoopStops,
      last < 0 ? words.no_loop : words.loop_value(ago),
    );

    const base = channels.value("base");
    show(this.battery.element, typeof base?.battery_v === "number");
    if (base) {
      // The charge does not follow from the voltage alone.
      const unmeasured = base.battery_low ? 0.15 : 1;
      const percent = base.battery_percent;
      const value = words.battery_value(base.battery_v, base.battery_low, percent);
      this.battery.set(
        typeof percent === "number" ? percent / 100 : unmeasured,
        with_age(channels, "base", value),
        base.battery_low ? "bad" : "good",
      );
    }
  }
}
