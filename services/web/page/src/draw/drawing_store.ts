// The drawing that the service has, read anew whenever somebody has saved.
import { Api } from "../api";
import { Rights } from "../app";
import { Channels } from "../channels";
import { Drawing, empty_drawing, parse_drawing } from "./drawing";

export interface Saved {
  version: string;
  message?: string;
}

const kMostReads = 3; // in a row

export class DrawingStore {
  drawing: Drawing = empty_drawing();
  version = ""; // empty: none was read yet
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

  /** Reads it anew; what cannot be read stays as it was. */
  read(): Promise<void> {
    this.reading ??= this.fetch().finally(() => (this.reading = null));
    return this.reading;
  }

  /**
   * Saves on top of a version; the new one, and what the service has to say about it. Throws an
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

  // Somebody may save while it is read: then once more.
  private async fetch(): Promise<void> {
    try {
      for (let i = 0; i < kMostReads && (i === 0 || this.is_old()); ++i) {
        const answer = await this.api.get<{ version: string }>("/api/drawing");
        this.take(parse_drawing(answer), String(answer.version));
      }
    } catch {
      // The next version, or the next connection, tries again.
    }
  }

  private take(drawing: Drawing, version: string): void {
    this.drawing = drawing;
    this.version = version;
    for (const listener of this.listeners) listener();
  }
}
