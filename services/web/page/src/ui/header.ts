// Always visible: what the robot does in large letters, how sure its position is, and Stop.
import { activity } from "../activity";
import { Api } from "../api";
import { Channels } from "../channels";
import { Rights } from "../rights";
import { is_map_alone, silenceTickMs, robot_state } from "../robot_state";
import { Stopping } from "../stopping";
import { texts } from "../texts";
import { AlarmBanner } from "./alarm_banner";
import { ControlsBanner } from "./controls_banner";
import { button, h, set_attribute, set_text, show } from "./dom";
import { HeldBanner } from "./held_banner";
import { Notices } from "./notices";
import { ResumeBanner } from "./resume_banner";
import { once_a_frame } from "./schedule";
import { listen_for_stop_key } from "./stop_key";

export class Header {
  readonly element: HTMLElement;
  readonly banners: HTMLElement;
  private readonly activity = h("strong", { class: "activity", id: "activity" });
  private readonly state = h("strong", { class: "state-word" });
  private readonly reason = h("span", { class: "state-reason" });
  private readonly stop: HTMLButtonElement;
  private readonly view_only: HTMLElement;
  private readonly offline = h("div", { class: "banner bad", role: "alert", hidden: true });
  private readonly stop_sent = h("div", {
    class: "banner bad",
    role: "alert",
    id: "stop-sent",
    hidden: true,
  });
  private readonly stopping: Stopping;
  private readonly held: HeldBanner;
  private readonly resume: ResumeBanner;
  private readonly controls: ControlsBanner;
  private readonly alarms: AlarmBanner;
  private readonly token = h("div", { class: "banner fair", role: "alert", hidden: true });

  /** Called by Stop in addition to its order. */
  on_stop: () => void = () => undefined;
  /** The operator wants to see all alarms. */
  on_show_alarms: () => void = () => undefined;

  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    api: Api,
    notices: Notices,
    extra: HTMLElement[],
  ) {
    this.stop = button(texts.stop, () => this.stop_now(), {
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
      h("div", { class: "state", role: "status", id: "state" }, this.activity, this.state, this.reason),
      h("div", { class: "header-end" }, ...extra, this.view_only, this.stop),
    );
    const update = once_a_frame(() => this.update());
    const on_held = () => notices.show(texts.done.stop);
    const on_unheard = (text: string) => notices.show(text, "error");
    this.stopping = new Stopping(channels, rights, api, update, on_held, on_unheard);
    this.held = new HeldBanner(channels, rights, api, notices, () => this.stopping.forget());
    this.controls = new ControlsBanner(channels, rights, api, notices);
    this.resume = new ResumeBanner(channels, rights, api, notices);
    this.alarms = new AlarmBanner(channels, rights, api, notices, () => this.on_show_alarms());
    this.banners = h(
      "div",
      { class: "banners" },
      this.offline,
      this.stop_sent,
      this.held.element,
      this.alarms.element,
      this.resume.element,
      this.controls.element,
      this.token,
    );
    channels.on_value(["pose", "scan", "base", "drive", "goals", "navigator", "controls"], update);
    channels.on_table("services", update);
    channels.on_table("alarms", update);
    rights.on_change(update);
    setInterval(update, silenceTickMs);
    listen_for_stop_key(() => this.stop_now());
    this.update();
  }

  show_token_error(): void {
    set_text(this.token, texts.wrong_token);
    show(this.token, true);
  }

  /** Stops the robot in any state, even one that was never heard. False: this page may not. */
  stop_now(): boolean {
    if (!this.rights.may_write) return false;
    void this.stopping.stop(() => this.on_stop());
    return true;
  }

  private update(): void {
    const state = robot_state(this.channels, this.rights);
    const now = activity(this.channels, this.rights);
    set_text(this.activity, now?.text ?? "");
    show(this.activity, now !== null);
    set_attribute(this.activity, "data-level", now?.level ?? "plain");
    set_text(this.state, state.word);
    set_text(this.reason, state.reason);
    set_attribute(this.element, "data-state", state.name);
    const alone = is_map_alone(this.channels);
    show(this.stop, this.rights.may_write && !alone);
    show(this.view_only, !this.rights.may_write && this.rights.connected && !alone);
    set_text(this.offline, texts.reconnecting);
    show(this.offline, !this.rights.connected);
    const unconfirmed = this.stopping.text();
    set_text(this.stop_sent, unconfirmed ?? "");
    show(this.stop_sent, unconfirmed !== null);
    this.held.update();
    this.alarms.update();
    this.resume.update();
    this.controls.update();
  }
}
