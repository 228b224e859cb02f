// Orders to the service, with the operator's token.
import { beside_page } from "./address";
import { translated } from "./reasons";
import { texts } from "./texts";

const timeoutMs = 10000;

/** A proxy may serve pages of several robots below paths of one site. */
function token_key(): string {
  return `topogeo-token:${beside_page("/")}`;
}

/**
 * The token of the operator's link. It is removed from the address, so that nobody copies it by
 * mistake.
 */
export function take_token(): string {
  const match = /[#&]token=([^&]+)/.exec(location.hash);
  if (match) {
    sessionStorage.setItem(token_key(), decodeURIComponent(match[1]));
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(token_key()) ?? "";
}

/** Why an order was refused, as a sentence for people; status: of HTTP, 0 without an answer. */
export class ApiError extends Error {
  constructor(
    message: string,
    readonly status = 0,
    readonly answer: Record<string, unknown> = {},
  ) {
    super(message);
  }
}

export class Api {
  /** page: the secret id of this page. */
  constructor(
    private readonly token: string,
    private readonly page: string,
  ) {}

  /** GET of a resource as JSON. Throws an ApiError. */
  async get<Answer>(path: string, timeout_ms = timeoutMs): Promise<Answer> {
    return read_json<Answer>(await this.request("GET", path, undefined, timeout_ms));
  }

  /** GET of a file. Throws an ApiError. */
  async download(path: string, timeout_ms: number): Promise<Blob> {
    return (await this.request("GET", path, undefined, timeout_ms)).blob();
  }

  /** POST of an order; returns its answer. Throws an ApiError. */
  async post<Answer = unknown>(
    what: string,
    body: unknown = {},
    timeout_ms = timeoutMs,
  ): Promise<Answer> {
    const text = JSON.stringify(body);
    return read_json<Answer>(await this.request("POST", `/api/${what}`, text, timeout_ms));
  }

  /** POST of a file; returns its answer. Throws an ApiError. */
  async send_file<Answer>(what: string, file: Blob, timeout_ms: number): Promise<Answer> {
    return read_json<Answer>(await this.request("POST", `/api/${what}`, file, timeout_ms));
  }

  private async request(
    method: string,
    path: string,
    body: string | Blob | undefined,
    timeout_ms: number,
  ): Promise<Response> {
    const abort = new AbortController();
    const timer = window.setTimeout(() => abort.abort(), timeout_ms);
    const headers: Record<string, string> = {};
    if (this.token) headers.Authorization = `Bearer ${this.token}`;
    if (this.token && method === "POST") headers["X-Topogeo-Page"] = this.page;
    if (typeof body === "string") headers["Content-Type"] = "application/json";
    else if (body) headers["Content-Type"] = "application/octet-stream";
    try {
      const response = await fetch(beside_page(path), { method, headers, body, signal: abort.signal });
      if (response.ok) return response;
      const answer = await read_json<{ error?: string }>(response);
      const message = translated(answer.error ?? "") || texts.errors.status(response.status);
      throw new ApiError(message, response.status, answer);
    } catch (error) {
      if (error instanceof ApiError) throw error;
      throw new ApiError(abort.signal.aborted ? texts.errors.slow : texts.errors.unreachable);
    } finally {
      window.clearTimeout(timer);
    }
  }
}

async function read_json<Answer>(response: Response): Promise<Answer> {
  return (await response.json().catch(() => ({}))) as Answer;
}
