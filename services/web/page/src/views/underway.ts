// The robot's goal, its progress and obstacles; pause, resume, cancel.
import { App } from "../app";
import { Maybe } from "../format";
import { has_foreign_goal, is_paused, navigator_text, rest_of_wait, silenceTickMs } from "../robot_state";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { once_a_frame } from "../ui/schedule";
import { section } from "../ui/section";

const words = texts.send;
const of_missions = texts.missions;
const nearM = 0.05; // a nearer point is reached
type Order = "pause" | "resume" | "cancel";

export class Underway {
  readonly element: HTMLElement;
  private readonly goal = h("h3");
  private readonly state = h("p", { role: "status" });
  private readonly rest = h("p", { class: "quiet" });
  private readonly waiting = h("p", { class: "quiet" });
  private readonly fill = h("span", { class: "bar-fill" });
  private readonly progress = h(
    "div",
    {
      class: "bar-meter progress",
      role: "progressbar",
      "aria-label": words.progress,
      "aria-valuemin": 0,
      "aria-valuemax": 100,
    },
    this.fill,
  );
  private readonly buttons: Record<Order, HTMLButtonElement>;

  constructor(private readonly app: App) {
    const order = (what: Order) => button(words[what], () => void this.send(what));
    this.buttons = { pause: order("pause"), resume: order("resume"), cancel: order("cancel") };
    this.element = section(
      words.underway,
      this.goal,
      this.progress,
      this.rest,
      this.state,
      this.waiting,
      h("div", { class: "buttons" }, ...Object.values(this.buttons)),
    );
    const update = once_a_frame(() => this.update());
    app.channels.on_value(["navigator", "goals"], update);
    app.channels.on_table("rooms", update);
    app.rights.on_change(update);
    setInterval(update, silenceTickMs);
    this.update();
  }

  private async send(what: Order): Promise<void> {
    try {
      await this.app.api.post(what);
    } catch (error) {
      this.app.notices.fail(error);
    }
  }

  // Without a connection the robot's state is unknown.
  private title(): string {
    const { channels, rights } = this.app;
    const goals = channels.value("goals");
    if (!rights.connected) return words.not_heard;
    if (goals?.exploring) return words.exploring;
    if (goals?.exploration?.ended && !goals.current) return words.explored;
    const wait_s = rest_of_wait(channels);
    if (goals?.current && wait_s > 0) return of_missions.stays(goals.current.text, wait_s);
    if (goals?.current) return words.to(goals.current.text);
    return has_foreign_goal(channels) ? words.foreign : words.idle;
  }

  /** rest_m: null if there is none. */
  private rest_text(rest_m: number | null, rest_s: Maybe): string {
    const goals = this.app.channels.value("goals");
    const progress = goals?.exploration;
    if (goals?.current && !goals.exploring) return rest_m === null ? "" : words.rest(rest_m, rest_s);
    if (!progress) return "";
    let floor = 0;
    for (const room of this.app.channels.table("rooms").values()) floor += room.area_m2;
    const facts = words.explored_facts(progress.visited, progress.given_up, floor);
    if (progress.ended) return `${facts}.`;
    const next =
      (rest_m ?? 0) < nearM ? words.next_point : `${words.rest_exploring(rest_m, rest_s)}.`;
    return `${facts}. ${next}`;
  }

  private update(): void {
    const { channels, rights } = this.app;
    const navigator = channels.value("navigator");
    const goals = channels.value("goals");
    const goal = goals?.current ?? null;
    const exploring = goals?.exploring ?? false;
    set_text(this.goal, this.title());
    set_text(this.state, navigator_text(channels, rights));
    // Idle shows in the goal; pages that may command report a missing navigator elsewhere.
    const missing = rights.connected && !rights.may_write;
    show(this.state, navigator ? navigator.state !== "idle" : missing);

    const moving = navigator !== null && (goal !== null || exploring);
    const arrived = navigator?.state === "arrived";
    const rest = arrived ? 0 : (navigator?.rest_m ?? null);
    const driven = navigator?.driven_m ?? 0;
    const known = moving && typeof rest === "number" && driven + rest > 0;
    // An exploration has no known end, and its next point is not chosen yet while it looks.
    show(this.progress, known && !exploring);
    if (known) {
      const percent = Math.round((100 * driven) / (driven + rest));
      this.fill.style.width = `${percent}%`;
      set_attribute(this.progress, "aria-valuenow", String(percent));
    }
    const text = this.rest_text(known && !arrived ? rest : null, navigator?.rest_s);
    show(this.rest, text !== "");
    set_text(this.rest, text);
    const waiting = (goals?.waiting ?? []).map((entry) => entry.text);
    const round = goals?.round ? `${of_missions.round(goals.round.now, goals.round.of)}. ` : "";
    const then = waiting.length > 0 ? words.waiting(waiting.join(", ")) : "";
    show(this.waiting, round + then !== "");
    set_text(this.waiting, round + then);

    // Also at a goal that was reached: the next one waits for a resume.
    const paused = is_paused(channels);
    const driving = moving && !arrived && navigator.reason !== "cancelled";
    const under_way = exploring || driving;
    show(this.buttons.pause, rights.can("pause") && driving && !paused);
    const stays = !paused && rest_of_wait(channels) > 0;
    set_text(this.buttons.resume, stays ? of_missions.drive_on : words.resume);
    show(this.buttons.resume, rights.can("resume") && moving && (paused || stays));
    show(this.buttons.cancel, rights.can("cancel") && (under_way || waiting.length > 0));
  }
}
