// Orders to the service, with the operator's token.
import { texts } from "./texts";

const kTokenKey = "topogeo-token";
const kTimeoutMs = 10000;

/**
 * The token of the operator's link. It is taken out of the address, so that nobody copies it by
 * mistake.
 */
export function take_token(): string {
  const match = /[#&]token=([^&]+)/.exec(location.hash);
  if (match) {
    sessionStorage.setItem(kTokenKey, decodeURIComponent(match[1]));
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(kTokenKey) ?? "";
}

/** Why an order was not taken, as a sentence for people; status: of HTTP, 0 without an answer. */
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
  constructor(private readonly token: string) {}

  /** GET of a resource as JSON. Throws an ApiError. */
  get<Answer>(path: string): Promise<Answer> {
    return this.request<Answer>("GET", path, undefined);
  }

  /** POST of an order, its answer. Throws an ApiError. */
  post<Answer = unknown>(what: string, body: unknown = {}): Promise<Answer> {
    return this.request<Answer>("POST", `/api/${what}`, JSON.stringify(body));
  }

  private async request<Answer>(method: string, path: string, body?: string): Promise<Answer> {
    const abort = new AbortController();
    const timer = window.setTimeout(() => abort.abort(), kTimeoutMs);
    const headers: Record<string, string> = {};
    if (this.token) headers.Authorization = `Bearer ${this.token}`;
    if (body !== undefined) headers["Content-Type"] = "application/json";
    try {
      const response = await fetch(path, { method, headers, body, signal: abort.signal });
      const answer = (await response.json().catch(() => ({}))) as Answer & { error?: string };
      if (!response.ok) {
        const message = answer.error || texts.errors.status(response.status);
        throw new ApiError(message, response.status, answer);
      }
      return answer;
    } catch (error) {
      if (error instanceof ApiError) throw error;
      throw new ApiError(abort.signal.aborted ? texts.errors.slow : texts.errors.unreachable);
    } finally {
      window.clearTimeout(timer);
    }
  }
}
