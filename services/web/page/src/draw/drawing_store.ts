// The service's drawing, read again whenever anybody has saved.
import { Api } from "../api";
import { Channels } from "../channels";
import { Drawing, empty_drawing, parse_drawing } from "./drawing";
import { Rights } from "../rights";

export interface Saved {
  version: string;
  message?: string;
}

const mostReads = 3; // in a row

export class DrawingStore {
  drawing: Drawing = empty_drawing();
  version = ""; // empty: none read yet
  private reading: Promise<void> | null = null;
  private readonly listeners: (() => void)[] = [];

  constructor(
    private readonly api: Api,
    private readonly channels: Channels,
    rights: Rights,
  ) {
    const read = () => {
      if (rights.connected && rights.knows("drawing") && this.is_old()) void this.read();
    };
    channels.on_value(["drawing"], read);
    rights.on_change(read);
  }

  on_change(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Reads the drawing again; after a failure the previous one stays. */
  read(): Promise<void> {
    this.reading ??= this.fetch().finally(() => (this.reading = null));
    return this.reading;
  }

  /**
   * Saves on top of a version; returns the new version and the service's message. Throws an
   * ApiError, 409 when others have saved.
   */
  async save(drawing: Drawing, version: string): Promise<Saved> {
    const answer = await this.api.post<Saved>("drawing", { version, ...drawing });
    this.take(drawing, answer.version);
    return answer;
  }

  private is_old(): boolean {
    const newest = this.channels.value("drawing")?.version;
    return this.version === "" || (newest !== undefined && newest !== this.version);
  }

  // Read once more if somebody saves during the read.
  private async fetch(): Promise<void> {
    try {
      for (let i = 0; i < mostReads && (i === 0 || this.is_old()); ++i) {
        const answer = await this.api.get<{ version: string }>("/api/drawing");
        this.take(parse_drawing(answer), String(answer.version));
      }
    } catch {
      // The next version or connection tries again.
    }
  }

  private take(drawing: Drawing, version: string): void {
    this.drawing = drawing;
    this.version = version;
    for (const listener of this.listeners) listener();
  }
}
