// Shows which other page has the controls, and lets this one ask for them, take them over, or answer
// a page that asks.
import { Api } from "../api";
import { Channels } from "../channels";
import { Controls } from "../protocol";
import { Rights } from "../rights";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "./dom";
import { Notices } from "./notices";

const words = texts.controls_of_robot;

export class ControlsBanner {
  readonly element = h("div", { class: "banner fair", role: "status", id: "controls", hidden: true });
  private readonly words = h("span");
  private readonly ask: HTMLButtonElement;
  private readonly take: HTMLButtonElement;
  private readonly give: HTMLButtonElement;
  private readonly keep: HTMLButtonElement;
  private before: Controls | null = null;

  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    private readonly api: Api,
    private readonly notices: Notices,
  ) {
    this.ask = button(words.ask, () => void this.order("ask"));
    this.take = button(words.take, () => void this.order("take"));
    this.give = button(words.give, () => void this.order("give"));
    this.keep = button(words.keep, () => void this.order("keep"));
    const buttons = h("span", { class: "buttons" }, this.ask, this.take, this.give, this.keep);
    this.element.append(this.words, buttons);
    channels.on_value(["controls"], () => this.tell_changes());
  }

  update(): void {
    const controls = this.rights.connected ? this.channels.value("controls") : null;
    const me = this.rights.page;
    const holder = controls?.holder ?? null;
    const asking = controls?.asking ?? null;
    const another = this.rights.may_write && me !== 0 && holder !== null && holder.page !== me;
    const asked = holder?.page === me && asking !== null && me !== 0;
    show(this.element, another || asked);
    if (!another && !asked) return;
    const i_ask = asking?.page === me;
    const name = holder?.name ?? "";
    set_text(
      this.words,
      asked ? words.asks(asking.name) : i_ask ? words.waiting(name) : words.other(name),
    );
    set_attribute(this.element, "role", asked ? "alert" : "status");
    show(this.ask, another && !i_ask);
    show(this.take, another);
    show(this.give, asked);
    show(this.keep, asked);
  }

  private async order(what: string): Promise<void> {
    try {
      await this.api.post("controls", { do: what });
    } catch (error) {
      this.notices.fail(error);
    }
  }

  // Both operators learn of each change.
  private tell_changes(): void {
    const before = this.before;
    const now = this.channels.value("controls");
    this.before = now;
    const me = this.rights.page;
    if (!before || !now || me === 0 || !this.rights.may_write) return;
    const had = before.holder?.page === me;
    const have = now.holder?.page === me;
    if (!had && have && before.holder) this.notices.show(words.got);
    if (had && !have && now.holder) this.notices.show(words.lost(now.holder.name), "error");
    if (before.asking?.page === me && !now.asking && !have && now.holder) {
      this.notices.show(words.kept(now.holder.name), "error");
    }
  }
}
