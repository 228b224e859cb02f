// After a stop and its release: offers to continue what the stop has interrupted.
import { Api } from "../api";
import { Channels } from "../channels";
import { Rights } from "../rights";
import { hand_is_stopped, has_foreign_goal, held_text, interrupted_goal } from "../robot_state";
import { texts } from "../texts";
import { button, h, set_text, show } from "./dom";
import { Notices } from "./notices";

export class ResumeBanner {
  readonly element = h("div", { class: "banner fair", role: "status", hidden: true });
  private readonly words = h("span");
  private readonly resume: HTMLButtonElement;

  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    api: Api,
    notices: Notices,
  ) {
    this.resume = button("", () => void notices.report(api.post("resume"), texts.done.resume));
    const forget = button(texts.forget, () =>
      void notices.report(api.post("cancel"), texts.done.forget),
    );
    this.element.append(this.words, h("span", { class: "buttons" }, this.resume, forget));
  }

  update(): void {
    const goal = this.offered();
    show(this.element, goal !== null);
    if (goal === null) return;
    set_text(this.words, texts.interrupted(goal));
    set_text(this.resume, texts.resume_to(goal));
  }

  private offered(): string | null {
    const { channels, rights } = this;
    const goals = channels.value("goals");
    const held = held_text(channels) !== null || hand_is_stopped(channels);
    const under_way = goals?.current || goals?.exploring || has_foreign_goal(channels);
    if (held || under_way || !rights.can("resume")) return null;
    return interrupted_goal(channels);
  }
}
