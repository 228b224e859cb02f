// Short messages that go by themselves; errors stay longer.
import { button, h } from "./dom";
import { sentence } from "../robot_state";
import { texts } from "../texts";

const kShownMs = { info: 4000, error: 10000 };

export class Notices {
  readonly element = h("div", { class: "notices", role: "status", "aria-live": "polite" });

  show(text: string, kind: "info" | "error" = "info"): void {
    for (const shown of this.element.children) {
      if (shown.firstElementChild?.textContent === text) return; // repeated many times a second
    }
    const notice = h("div", { class: `notice ${kind}` }, h("span", {}, text));
    notice.append(
      button("×", () => notice.remove(), { class: "notice-close", "aria-label": texts.close }),
    );
    this.element.append(notice);
    while (this.element.childElementCount > 3) this.element.firstElementChild?.remove();
    window.setTimeout(() => notice.remove(), kShownMs[kind]);
  }

  /** Reports what becomes of an order. True when it was taken. */
  async report(order: Promise<unknown>, done: string): Promise<boolean> {
    try {
      const answer = (await order) as { message?: string } | null;
      this.show(answer?.message ? sentence(answer.message) : done);
      return true;
    } catch (error) {
      this.fail(error);
      return false;
    }
  }

  /** Says why something was not done. */
  fail(error: unknown): void {
    this.show(sentence(error instanceof Error ? error.message : String(error)), "error");
  }
}
