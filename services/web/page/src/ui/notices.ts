// Short messages that disappear by themselves; errors stay longer.
import { button, h } from "./dom";
import { reason } from "../reasons";
import { texts } from "../texts";

const shownMs = { info: 4000, error: 10000 };
const signMs = 200; // a faster answer needs no waiting notice
const slowMs = 3000;

export class Notices {
  readonly element = h("div", { class: "notices", role: "status", "aria-live": "polite" });

  show(text: string, kind: "info" | "error" = "info"): void {
    for (const shown of this.element.children) {
      if (shown.firstElementChild?.textContent === text) return; // repeated many times a second
    }
    const notice = this.add(text, kind);
    window.setTimeout(() => notice.remove(), shownMs[kind]);
  }

  /** Reports that an order was sent, and its outcome. Returns true if it was accepted. */
  async report(order: Promise<unknown>, done: string): Promise<boolean> {
    const end_waiting = this.show_waiting();
    try {
      const answer = (await order) as { message?: string } | null;
      this.show(answer?.message ? reason(answer.message) : done);
      return true;
    } catch (error) {
      this.fail(error);
      return false;
    } finally {
      end_waiting();
    }
  }

  /** Reports why something was not done. */
  fail(error: unknown): void {
    this.show(reason(error instanceof Error ? error.message : String(error)), "error");
  }

  private add(text: string, kind: string): HTMLElement {
    const notice = h("div", { class: `notice ${kind}` }, h("span", {}, text));
    notice.append(
      button("×", () => notice.remove(), { class: "notice-close", "aria-label": texts.close }),
    );
    this.element.append(notice);
    while (this.element.childElementCount > 3) this.element.firstElementChild?.remove();
    return notice;
  }

  // Shows that an answer is awaited; the returned function removes the notice.
  private show_waiting(): () => void {
    let notice: HTMLElement | null = null;
    const sign = window.setTimeout(() => (notice = this.add(texts.waiting.sent, "info")), signMs);
    const slow = window.setTimeout(() => {
      const words = notice?.firstElementChild;
      if (words) words.textContent = texts.waiting.slow;
    }, slowMs);
    return () => {
      window.clearTimeout(sign);
      window.clearTimeout(slow);
      notice?.remove();
    };
  }
}
