// Events, newest first: all or those of a level, and as a file.
import { App } from "../app";
import * as format from "../format";
import { LogEvent } from "../protocol";
import { translated } from "../reasons";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";

const words = texts.understand;
const shownEvents = 200;

type Filter = keyof typeof words.event_filters;

const levels: Record<Filter, LogEvent["level"][]> = {
  all: ["info", "warning", "error"],
  trouble: ["warning", "error"],
  errors: ["error"],
};

/** A line for each event, the oldest first: time, level, source and text, with tabs between. */
export function events_as_text(events: LogEvent[]): string {
  const line = ({ time_s, level, source, text }: LogEvent) =>
    [new Date(1000 * time_s).toISOString(), level, source, text.replace(/\s+/g, " ")].join("\t");
  return events.map((event) => `${line(event)}\n`).join("");
}

export class EventList {
  readonly element: HTMLElement;
  private readonly none = h("p", { class: "quiet" }, words.no_events);
  private readonly filters: [Filter, HTMLButtonElement][];
  private readonly save: HTMLButtonElement;
  private readonly list: KeyedList<LogEvent>;
  private filter: Filter = "all";

  constructor(private readonly app: App) {
    this.filters = (Object.keys(words.event_filters) as Filter[]).map((filter) => [
      filter,
      button(words.event_filters[filter], () => this.set_filter(filter), { class: "button small" }),
    ]);
    this.save = button(words.save_events, () => this.save_now(), { class: "button small" });
    this.list = new KeyedList<LogEvent>(
      "events",
      () => h("li", {}, h("time"), h("span", { class: "source" }), h("span", { class: "text" })),
      show_event,
    );
    this.list.element.tabIndex = 0; // scrollable by keyboard
    this.list.element.setAttribute("aria-label", words.events);
    this.element = h(
      "div",
      {},
      h(
        "div",
        { class: "buttons", role: "group", "aria-label": words.event_filter_label },
        ...this.filters.map(([, element]) => element),
        this.save,
      ),
      this.none,
      this.list.element,
    );
  }

  update(): void {
    const events = this.newest_first().filter(([, event]) => levels[this.filter].includes(event.level));
    for (const [filter, element] of this.filters) {
      set_attribute(element, "aria-pressed", String(filter === this.filter));
    }
    const any = this.app.channels.table("events").size > 0;
    show(this.save, any);
    set_text(this.none, any ? words.no_such_events : words.no_events);
    show(this.none, events.length === 0);
    this.list.show(events.slice(0, shownEvents));
  }

  private newest_first(): [string, LogEvent][] {
    return [...this.app.channels.table("events")].sort((a, b) => Number(b[0]) - Number(a[0]));
  }

  private set_filter(filter: Filter): void {
    this.filter = filter;
    this.update();
  }

  private save_now(): void {
    const events = this.newest_first().map(([, event]) => event);
    const blob = new Blob([events_as_text(events.reverse())], { type: "text/tab-separated-values" });
    const link = h("a", { href: URL.createObjectURL(blob), download: "events.tsv" });
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
}

function show_event(element: HTMLElement, event: LogEvent): void {
  const [time, source, text] = element.children as unknown as HTMLElement[];
  set_text(time, format.clock(event.time_s));
  set_text(source, event.source);
  const level = event.level === "info" ? "" : `${words.levels[event.level]}: `;
  set_text(text, level + translated(event.text));
  set_attribute(element, "data-level", event.level);
}
