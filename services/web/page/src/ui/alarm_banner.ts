// The newest alarm that nobody has acknowledged, in view whatever view is open.
import { acknowledge, alarm_text, pending_alarms } from "../alarms";
import { Api } from "../api";
import { Channels } from "../channels";
import { clock } from "../format";
import { Rights } from "../rights";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "./dom";
import { Notices } from "./notices";

const words = texts.alarms;

export class AlarmBanner {
  readonly element = h("div", { class: "banner bad alarm", role: "alert", hidden: true });
  private readonly words = h("span");
  private readonly acknowledge: HTMLButtonElement;
  private readonly all: HTMLButtonElement;

  /** on_show: the operator wants to see all alarms. */
  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    api: Api,
    notices: Notices,
    on_show: () => void,
  ) {
    this.acknowledge = button(words.acknowledge, () => {
      const numbers = pending_alarms(channels).map(([number]) => number);
      void acknowledge(api, notices, numbers.slice(0, 1));
    });
    this.all = button("", on_show);
    this.element.append(this.words, h("span", { class: "buttons" }, this.acknowledge, this.all));
  }

  update(): void {
    const pending = pending_alarms(this.channels);
    show(this.element, pending.length > 0);
    if (pending.length === 0) return;
    const [, newest] = pending[0];
    set_text(this.words, `${clock(newest.time_s)} ${alarm_text(newest)}`);
    set_text(this.all, words.all(pending.length));
    set_attribute(this.all, "aria-label", words.show(pending.length));
    show(this.all, pending.length > 1);
    show(this.acknowledge, this.rights.can("alarms"));
  }
}
