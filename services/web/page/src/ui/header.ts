// Always in view: the state in large letters with its reason, and Stop.
import { Api } from "../api";
import { Rights } from "../app";
import { Channels } from "../channels";
import { held_text, kSilenceTick_ms, robot_state } from "../robot_state";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "./dom";
import { Notices } from "./notices";
import { once_a_frame } from "./schedule";

export class Header {
  readonly element: HTMLElement;
  readonly banners: HTMLElement;
  private readonly state = h("strong", { class: "state-word" });
  private readonly reason = h("span", { class: "state-reason" });
  private readonly stop: HTMLButtonElement;
  private readonly view_only: HTMLElement;
  private readonly offline = h("div", { class: "banner bad", role: "alert", hidden: true });
  private readonly held_words = h("span");
  private readonly held: HTMLElement;
  private readonly token = h("div", { class: "banner fair", role: "alert", hidden: true });

  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    private readonly api: Api,
    private readonly notices: Notices,
    extra: HTMLElement[],
  ) {
    this.stop = button(texts.stop, () => void this.stop_now(), {
      class: "stop",
      title: texts.stop_title,
      id: "stop",
    });
    this.view_only = h(
      "span",
      { class: "view-only", title: texts.view_only_title },
      texts.view_only,
    );
    this.element = h(
      "header",
      { class: "header" },
      h("div", { class: "state", role: "status", id: "state" }, this.state, this.reason),
      h("div", { class: "header-end" }, ...extra, this.view_only, this.stop),
    );
    const release = button(texts.release, () => {
      void notices.report(api.post("release"), texts.done.release);
    });
    this.held = h("div", { class: "banner bad", role: "alert", hidden: true });
    this.held.append(this.held_words, release);
    this.banners = h("div", { class: "banners" }, this.offline, this.held, this.token);
    const update = once_a_frame(() => this.update(release));
    channels.on_value(["pose", "base"], update);
    channels.on_table("services", update);
    rights.on_change(update);
    setInterval(update, kSilenceTick_ms);
    this.listen_for_space();
    this.update(release);
  }

  show_token_error(): void {
    set_text(this.token, texts.wrong_token);
    show(this.token, true);
  }

  /** Stops the robot, whatever it does. */
  async stop_now(): Promise<void> {
    if (!this.rights.may_write) return;
    await this.notices.report(this.api.post("stop"), texts.done.stop);
  }

  private update(release: HTMLButtonElement): void {
    const state = robot_state(this.channels, this.rights);
    set_text(this.state, state.word);
    set_text(this.reason, state.reason);
    set_attribute(this.element, "data-state", state.name);
    show(this.stop, this.rights.may_write);
    show(this.view_only, !this.rights.may_write && this.rights.connected);
    set_text(this.offline, texts.reconnecting);
    show(this.offline, !this.rights.connected);
    const held = this.rights.connected ? held_text(this.channels) : null;
    set_text(this.held_words, held ?? "");
    show(this.held, held !== null);
    show(release, this.rights.can("release"));
  }

  // Space stops, but where it types or presses something.
  private listen_for_space(): void {
    document.addEventListener("keydown", (event) => {
      const target = event.target as HTMLElement;
      if (event.key !== " " || event.repeat) return;
      if (target.closest("button, input, select, textarea, summary, a")) return;
      event.preventDefault();
      void this.stop_now();
    });
  }
}
