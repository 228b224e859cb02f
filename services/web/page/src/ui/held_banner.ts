// Shows that the robot is held and the effect of its release, and releases it.
import { Api } from "../api";
import { Channels } from "../channels";
import { Rights } from "../rights";
import { hand_is_stopped, held_text, interrupted_goal, pending_goal } from "../robot_state";
import { texts } from "../texts";
import { button, h, set_text, show } from "./dom";
import { Notices } from "./notices";

export class HeldBanner {
  readonly element = h("div", { class: "banner bad", role: "alert", hidden: true });
  private readonly words = h("span");
  private readonly release: HTMLButtonElement;
  private readonly answers: HTMLElement;
  private asked: string | null = null; // goal named in the question

  /** on_release: the release order was accepted. */
  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    private readonly api: Api,
    private readonly notices: Notices,
    private readonly on_release: () => void,
  ) {
    this.release = button(texts.release, () => this.ask());
    this.answers = h(
      "span",
      { class: "buttons", hidden: true },
      button(texts.release_and_drive, () => void this.send()),
      button(texts.release_and_cancel, () => void this.send(true)),
      button(texts.keep_held, () => this.answer()),
    );
    this.element.append(this.words, this.release, this.answers);
  }

  update(): void {
    const text = this.rights.connected ? this.state_text() : null;
    if (text === null || this.held_goal() !== this.asked) this.asked = null;
    set_text(this.words, this.asked === null ? (text ?? "") : texts.release_asks(this.asked));
    show(this.element, text !== null);
    show(this.release, this.asked === null && this.rights.can("release"));
    show(this.answers, this.asked !== null && this.rights.can("release"));
  }

  /** The effect of the stop; null if none holds. */
  private state_text(): string | null {
    const goal = this.held_goal();
    const held = held_text(this.channels);
    if (held === null && !hand_is_stopped(this.channels)) return null;
    if (goal !== null) {
      return held === null ? texts.hand_stopped_with_goal(goal) : texts.held_with_goal(goal);
    }
    const text = held ?? texts.hand_stopped;
    const interrupted = interrupted_goal(this.channels);
    return interrupted === null ? text : texts.interrupted_held(text, interrupted);
  }

  /** The goal that waits for the release; null if there is none. */
  private held_goal(): string | null {
    const held = held_text(this.channels) !== null || hand_is_stopped(this.channels);
    return held ? pending_goal(this.channels) : null;
  }

  // A robot with a goal drives as soon as it may, so the release asks for confirmation.
  private ask(): void {
    this.asked = this.held_goal();
    if (this.asked === null) void this.send();
    else this.update();
  }

  private answer(): void {
    this.asked = null;
    this.update();
  }

  private async send(cancel = false): Promise<void> {
    this.answer();
    if (cancel && !(await this.notices.report(this.api.post("cancel"), texts.done.cancel))) return;
    if (await this.notices.report(this.api.post("release"), texts.done.release)) this.on_release();
  }
}
