// Alarms: those that wait for an acknowledgment, then the others with who acknowledged them.
import { acknowledge, alarm_text, newest_alarms, pending_alarms } from "../alarms";
import { App } from "../app";
import { clock } from "../format";
import { Alarm } from "../protocol";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";

const words = texts.alarms;

export class AlarmList {
  readonly element: HTMLElement;
  private readonly none = h("p", { class: "quiet" }, words.none);
  private readonly all: HTMLButtonElement;
  private readonly list: KeyedList<Alarm>;

  constructor(private readonly app: App) {
    this.all = button("", () => {
      const numbers = pending_alarms(app.channels).map(([number]) => number);
      void acknowledge(app.api, app.notices, numbers);
    });
    this.list = new KeyedList<Alarm>(
      "rows alarms",
      (number) => {
        const one = () => void acknowledge(app.api, app.notices, [number]);
        const done = button(words.acknowledge, one, { class: "button small" });
        return h("li", {}, h("time"), h("span", { class: "text" }), h("span", { class: "quiet" }), done);
      },
      (element, alarm) => this.show_alarm(element, alarm),
    );
    this.list.element.tabIndex = 0; // scrollable by keyboard
    this.list.element.setAttribute("aria-label", words.title);
    this.element = h("div", {}, this.none, this.all, this.list.element);
  }

  update(): void {
    const { channels, rights } = this.app;
    const pending = pending_alarms(channels);
    const others = newest_alarms(channels).filter(([, alarm]) => alarm.acknowledged_by !== "");
    show(this.none, pending.length + others.length === 0);
    show(this.list.element, pending.length + others.length > 0);
    show(this.all, pending.length > 1 && rights.can("alarms"));
    set_text(this.all, words.acknowledge_all(pending.length));
    this.list.show([...pending, ...others]);
  }

  private show_alarm(element: HTMLElement, alarm: Alarm): void {
    const [time, text, facts, done] = element.children as unknown as HTMLElement[];
    const waits = alarm.acknowledged_by === "";
    const parts = [];
    if (alarm.count > 1) parts.push(words.repeated(alarm.count, clock(alarm.time_s)));
    if (!waits) parts.push(words.acknowledged(alarm.acknowledged_by, clock(alarm.acknowledged_s ?? 0)));
    set_text(time, clock(alarm.first_s));
    set_text(text, alarm_text(alarm));
    set_text(facts, parts.join(". "));
    set_attribute(element, "data-level", waits ? (alarm.level === "error" ? "bad" : "fair") : "plain");
    set_attribute(done, "aria-label", words.acknowledge_one(alarm_text(alarm)));
    show(done, waits && this.app.rights.can("alarms"));
  }
}
