// The WebSocket: connects, continues after interruptions from the page's state, detects a dead
// connection.
import { socket_address } from "./address";
import { Channels } from "./channels";
import { Identity } from "./identity";
import { TableMessage, ValueMessage } from "./protocol";

const silenceMs = 5000; // the service sends something every two seconds
const pongMs = 1000;
const snapshotsMs = 5000; // until a new service has sent its whole state
const firstDelayMs = 500;
const longestDelayMs = 4000;
const mostLate = 20; // clocks that stood still disagree; a new connection corrects that

export interface Listener {
  /** page: number of this page among those of operators; 0: none. */
  connected(may_write: boolean, error: string, page: number): void;
  disconnected(): void;
  refused(what: string, error: string): void;
}

interface Control {
  op?: string;
  life?: string;
  may_write?: boolean;
  what?: string;
  error?: string;
  page?: number;
  late_s?: number;
}

/** With the token, in hexadecimal digits, the service reserves a place for this page. */
function protocols(token: string): string[] {
  if (!token) return ["topogeo"];
  const bytes = [...new TextEncoder().encode(token)];
  const digits = bytes.map((byte) => byte.toString(16).padStart(2, "0"));
  return ["topogeo", `token.${digits.join("")}`];
}

export class Connection {
  private socket: WebSocket | null = null;
  private life = "";
  private open = false;
  private delay_ms = firstDelayMs;
  private last_message_ms = 0;
  private pong_timer = 0;
  private retry_timer = 0;
  private late = 0; // orders of this connection

  /** names: the wanted channels; empty: all. */
  constructor(
    private readonly channels: Channels,
    private readonly token: string,
    private readonly identity: Identity,
    private readonly names: string[],
    private readonly listener: Listener,
  ) {
    window.setInterval(() => this.check_silence(), 1000);
    document.addEventListener("visibilitychange", () => this.on_visibility());
    window.addEventListener("online", () => this.reconnect_now());
    this.connect();
  }

  /** Sends a message of the page; false without a connection. */
  send(message: Record<string, unknown>): boolean {
    if (!this.open || this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  /** An order to drive by hand, with the time of this page, so that a delayed order is refused. */
  drive(linear_mps: number, angular_radps: number): void {
    this.send({ op: "drive", linear_mps, angular_radps, page_ms: performance.now() });
  }

  private connect(): void {
    const socket = new WebSocket(socket_address(), protocols(this.token));
    this.socket = socket;
    this.last_message_ms = Date.now();
    socket.onopen = () => {
      const hello: Record<string, unknown> = { op: "hello", page_ms: performance.now() };
      this.late = 0;
      const { id, name } = this.identity;
      if (this.token) Object.assign(hello, { token: this.token, page: id, name });
      if (this.names.length > 0) hello.channels = this.names;
      if (this.life) Object.assign(hello, { life: this.life, have: this.channels.held() });
      socket.send(JSON.stringify(hello));
    };
    socket.onmessage = (event) => {
      if (this.socket !== socket) return;
      this.last_message_ms = Date.now();
      this.on_message(JSON.parse(String(event.data)) as Control | ValueMessage | TableMessage);
    };
    socket.onclose = () => {
      if (this.socket === socket) this.lose();
    };
  }

  private on_message(message: Control | ValueMessage | TableMessage): void {
    if ("channel" in message) {
      if (!this.channels.apply(message)) this.send({ op: "resync", channel: message.channel });
    } else if (message.op === "welcome") {
      this.follow_life(message.life ?? "");
      this.open = true;
      this.delay_ms = firstDelayMs;
      const { may_write, error, page } = message;
      this.listener.connected(may_write === true, error ?? "", page ?? 0);
    } else if (message.op === "pong") {
      window.clearTimeout(this.pong_timer);
    } else if (message.op === "refused") {
      if (message.late_s !== undefined && ++this.late > mostLate) return this.lose();
      this.listener.refused(message.what ?? "", message.error ?? "");
    }
  }

  // After a restart of the service, the old map stays until the new one arrives.
  private follow_life(life: string): void {
    if (this.life !== "" && this.life !== life) {
      this.channels.begin_anew();
      window.setTimeout(() => this.channels.drop_unconfirmed(), snapshotsMs);
    }
    this.life = life;
  }

  private lose(): void {
    const socket = this.socket;
    this.socket = null;
    this.open = false;
    window.clearTimeout(this.pong_timer);
    socket?.close();
    this.listener.disconnected();
    window.clearTimeout(this.retry_timer);
    this.retry_timer = window.setTimeout(() => this.connect(), this.delay_ms);
    this.delay_ms = Math.min(2 * this.delay_ms, longestDelayMs);
  }

  private reconnect_now(): void {
    if (this.socket) return;
    window.clearTimeout(this.retry_timer);
    this.delay_ms = firstDelayMs;
    this.connect();
  }

  private check_silence(): void {
    if (this.socket && Date.now() - this.last_message_ms > silenceMs) this.lose();
  }

  private on_visibility(): void {
    if (document.hidden) return;
    if (!this.socket) {
      this.reconnect_now();
    } else if (this.send({ op: "ping", page_ms: performance.now() })) {
      window.clearTimeout(this.pong_timer);
      this.pong_timer = window.setTimeout(() => this.lose(), pongMs);
    }
  }
}
