// Accepted and rejected loops with their reasons; the chosen one is shown on the map.
import { App } from "../app";
import { reason } from "../reasons";
import { Loop } from "../protocol";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { LoopDetail, meaning_of } from "./loop_detail";

const words = texts.understand;
const shownLoops = 100;

type Filter = keyof typeof words.filters;

export class LoopList {
  readonly element: HTMLElement;
  private readonly counts = h("p");
  private readonly empty = h("p", { class: "quiet" }, words.no_loops);
  private readonly more = h("p", { class: "quiet" });
  private readonly filters: [Filter, HTMLButtonElement][];
  private readonly list: KeyedList<Loop>;
  private readonly detail: LoopDetail;
  private filter: Filter = "all";
  private chosen = "";

  constructor(private readonly app: App) {
    this.filters = (Object.keys(words.filters) as Filter[]).map((filter) => [
      filter,
      button(words.filters[filter], () => this.set_filter(filter), { class: "button small" }),
    ]);
    this.list = new KeyedList<Loop>(
      "rows loops",
      (key) => this.entry(key),
      (element, loop, key) => this.show_entry(element, loop, key),
    );
    this.detail = new LoopDetail(app);
    this.element = h(
      "div",
      {},
      h("p", { class: "quiet" }, words.loops_hint),
      this.counts,
      h(
        "div",
        { class: "buttons", role: "group", "aria-label": words.filter_label },
        ...this.filters.map(([, element]) => element),
      ),
      this.empty,
      this.detail.element,
      this.list.element,
      this.more,
    );
  }

  /** Shows a loop on the map; null: none. */
  choose(key: string | null): void {
    this.chosen = key ?? "";
    const { scene } = this.app.map;
    const loop = this.app.channels.table("loops").get(this.chosen) ?? null;
    scene.chosen_loop = loop;
    this.detail.show(loop);
    const stop = loop && (scene.trail.stop(loop.later) ?? scene.trail.stop(loop.earlier));
    if (stop) {
      this.app.map.follow(false);
      this.app.map.show(stop[0], stop[1]);
    }
    scene.refresh();
    this.update();
  }

  update(): void {
    const all = [...this.app.channels.table("loops")];
    const accepted = all.filter(([, loop]) => loop.accepted).length;
    const from_file = all.every(([, loop]) => loop.accepted && loop.fitness === null);
    const counts = from_file
      ? words.loops_kept(accepted)
      : words.loops_count(accepted, all.length - accepted);
    set_text(this.counts, counts);
    show(this.counts, all.length > 0);
    show(this.empty, all.length === 0);
    for (const [filter, element] of this.filters) {
      set_attribute(element, "aria-pressed", String(filter === this.filter));
      show(element, all.length > 0 && !from_file);
    }
    const wanted = all
      .filter(([, loop]) => this.filter === "all" || loop.accepted === (this.filter === "accepted"))
      .sort((a, b) => Number(b[0]) - Number(a[0]));
    this.list.show(wanted.slice(0, shownLoops));
    show(this.more, wanted.length > shownLoops);
    set_text(this.more, words.more(Math.max(0, wanted.length - shownLoops)));
  }

  private set_filter(filter: Filter): void {
    this.filter = filter;
    this.update();
  }

  private entry(key: string): HTMLElement {
    const choose = () => this.choose(this.chosen === key ? null : key);
    const title = h("button", { type: "button", class: "row-title", onclick: choose });
    return h("li", {}, title, h("p"), h("p", { class: "quiet" }));
  }

  private show_entry(element: HTMLElement, loop: Loop, key: string): void {
    const [title, why, facts] = element.children as unknown as HTMLElement[];
    set_text(title, words.loop(loop.later, loop.earlier));
    set_attribute(title, "aria-pressed", String(key === this.chosen));
    set_text(why, `${reason_of(loop)} ${words.sources[loop.source] ?? ""}`);
    const { fitness, probability, correction_m, correction_rad } = loop;
    // A map file contains only closed loops.
    const measured = [fitness, probability, correction_m].some((value) => value !== null);
    set_text(
      facts,
      measured
        ? words.loop_facts(fitness, probability, correction_m, correction_rad, loop.accepted)
        : words.not_kept,
    );
    set_attribute(element, "data-level", loop.accepted ? "good" : "bad");
  }
}

/** Why it was rejected, as a sentence; or the outcome if there is no explanation. */
function reason_of(loop: Loop): string {
  if (loop.accepted && !loop.explanation) return words.accepted;
  const outcome = loop.explanation || words.outcomes[loop.outcome] || loop.outcome;
  return meaning_of(loop.explanation) || reason(outcome);
}
