// Addresses of the service relative to the page, which a proxy may serve below a path.

/** The address of a resource of the service, for example "/api/info". */
export function beside_page(path: string): string {
  return new URL(path.replace(/^\//, ""), document.baseURI).href;
}

export function socket_address(): string {
  const url = new URL(beside_page("/ws"));
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}
