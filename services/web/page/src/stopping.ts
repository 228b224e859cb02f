// A stop order counts as pending until the base itself confirms it: it is held, and it stands.
import { Api } from "./api";
import { Channels } from "./channels";
import { reason } from "./reasons";
import { Rights } from "./rights";
import { hand_is_stopped, held_text, is_map_alone } from "./robot_state";
import { texts } from "./texts";

export class Stopping {
  private sent_ms: number | null = null; // null: none pending
  private refused = "";
  private kept = ""; // how the stop is kept if no base hears it
  private hand_stopped = false;

  /**
   * on_change: text() may have changed; on_held: the base has confirmed a stop; on_unheard: nobody heard a stop on a page
   * that has had no robot, where nothing would ever confirm it.
   */
  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    private readonly api: Api,
    private readonly on_change: () => void,
    private readonly on_held: () => void,
    private readonly on_unheard: (text: string) => void,
  ) {
    for (const name of ["base", "time"] as const) {
      channels.on_value([name], () => this.check());
    }
    channels.on_value(["drive"], () => this.check_hand());
  }

  /** Sends the order, and again by `send` over the existing connection. */
  async stop(send: () => void): Promise<void> {
    if (!this.rights.may_write) return;
    this.sent_ms = performance.now();
    this.refused = "";
    this.kept = "";
    this.on_change();
    send();
    try {
      const answer = await this.api.post<{ message?: string }>("stop");
      this.kept = answer.message ? reason(answer.message) : "";
    } catch (error) {
      this.refused = reason(error instanceof Error ? error.message : String(error));
      if (is_map_alone(this.channels)) {
        this.sent_ms = null;
        this.on_unheard(texts.stop_failed(this.refused));
      }
    }
    this.on_change();
  }

  /** The robot was released: an earlier stop is no longer pending. */
  forget(): void {
    this.sent_ms = null;
    this.on_change();
  }

  /** Text shown until the base confirms the stop; null when none is pending. */
  text(): string | null {
    if (this.sent_ms === null) return null;
    if (this.is_held()) return texts.stop_moves;
    if (this.refused) return texts.stop_failed(this.refused);
    return this.kept || texts.stop_sent;
  }

  private check(): void {
    if (!this.is_held()) return;
    if (!this.channels.value("base")?.stands) return this.on_change();
    this.forget();
    this.on_held();
  }

  // No base of ROS confirms a stop, so the banner goes with the release.
  private check_hand(): void {
    const before = this.hand_stopped;
    this.hand_stopped = hand_is_stopped(this.channels);
    if (before && !this.hand_stopped && !this.channels.value("base")) this.forget();
  }

  // A report from before the stop order cannot confirm it.
  private is_held(): boolean {
    const age_ms = this.channels.age_ms("base");
    if (this.sent_ms === null || age_ms === null) return false;
    return age_ms < performance.now() - this.sent_ms && held_text(this.channels) !== null;
  }
}
