// Understand: causes of uncertainty, loop decisions, active services, events.
import { App, ViewPart } from "../app";
import * as format from "../format";
import { Worker } from "../protocol";
import { is_map_alone, silenceTickMs, pose_of_now, robot_state } from "../robot_state";
import { texts } from "../texts";
import { Bar } from "../ui/bar";
import { h, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { at_most_every } from "../ui/schedule";
import { folded, section } from "../ui/section";
import { AlarmList } from "./alarm_list";
import { EventList } from "./event_list";
import { LoopList } from "./loop_list";
import { SearchPart } from "./search_part";
import { ServiceList } from "./service_list";

const words = texts.understand;
const periodMs = 300;

export class UnderstandView implements ViewPart {
  readonly element: HTMLElement;
  private readonly reason = h("p");
  private readonly confidence = new Bar(texts.now.confidence);
  private readonly loops: LoopList;
  private readonly search: SearchPart;
  private readonly services: ServiceList;
  private readonly no_workers = h("p", { class: "quiet" }, words.no_workers);
  private readonly workers: KeyedList<Worker>;
  private readonly events: EventList;
  private readonly alarms: AlarmList;
  private visible = false;

  constructor(private readonly app: App) {
    this.loops = new LoopList(app);
    this.search = new SearchPart(app);
    this.services = new ServiceList(app);
    const bars = new WeakMap<HTMLElement, Bar>();
    this.workers = new KeyedList<Worker>(
      "rows",
      () => {
        const bar = new Bar(words.load);
        const element = h("li", {}, h("h3"), bar.element, h("p", { class: "quiet" }));
        bars.set(element, bar);
        return element;
      },
      (element, worker) => show_worker(element, bars.get(element), worker),
    );
    this.events = new EventList(app);
    this.alarms = new AlarmList(app);
    this.element = h(
      "div",
      { class: "view" },
      section(words.why, this.reason, this.confidence.element),
      folded(texts.alarms.title, true, this.alarms.element),
      folded(words.loops, true, this.loops.element),
      folded(words.search, true, this.search.element),
      folded(words.services, true, this.services.element),
      folded(words.workers, true, this.no_workers, this.workers.element),
      folded(words.events, true, this.events.element),
    );
    const update = at_most_every(periodMs, () => this.update());
    app.channels.on_value(["pose"], update);
    for (const table of ["loops", "services", "workers", "events", "alarms"] as const) {
      app.channels.on_table(table, update);
    }
    app.rights.on_change(update);
    setInterval(update, silenceTickMs);
  }

  shown(visible: boolean): void {
    this.visible = visible;
    this.search.set_visible(visible);
    if (visible) this.update();
    else this.loops.choose(null);
  }

  show_alarms(): void {
    this.alarms.element.parentElement?.scrollIntoView({ block: "start" });
  }

  private update(): void {
    if (!this.visible) return;
    const { channels, rights } = this.app;
    const state = robot_state(channels, rights);
    set_text(this.reason, `${state.word}. ${state.reason}`);
    show(this.confidence.element, !is_map_alone(channels));
    const confidence = pose_of_now(channels, rights)?.confidence;
    this.confidence.set(
      confidence ?? 0,
      format.percent(confidence),
      (confidence ?? 0) > 0.9 ? "good" : (confidence ?? 0) > 0.5 ? "fair" : "bad",
    );
    this.loops.update();
    this.services.update();
    const workers = [...channels.table("workers")];
    workers.sort((a, b) => a[1].name.localeCompare(b[1].name));
    show(this.no_workers, workers.length === 0);
    this.workers.show(workers);
    this.events.update();
    this.alarms.update();
  }
}

function show_worker(element: HTMLElement, bar: Bar | undefined, worker: Worker): void {
  const [name, , facts] = element.children as unknown as HTMLElement[];
  const draining = worker.draining ? ` (${words.draining})` : "";
  set_text(name, `${worker.name} · ${worker.host}${draining}`);
  bar?.set(worker.load ?? 0, format.percent(worker.load));
  const rate = format.rate(worker.tasks_per_s);
  set_text(facts, words.worker_facts(worker.slots, worker.tasks_done, rate, worker.failures));
}
