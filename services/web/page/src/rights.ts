// Whether there is a connection, and the rights of this page.
export class Rights {
  connected = false;
  may_write = false;
  page = 0; // number of this page among those of operators
  private offered: Set<string> | null = null;
  private readonly listeners: (() => void)[] = [];

  set_connected(connected: boolean, may_write: boolean, page = 0): void {
    this.connected = connected;
    this.page = page;
    this.may_write = connected ? may_write : this.may_write;
    this.notify();
  }

  set_offers(offers: string[]): void {
    this.offered = new Set(offers);
    this.notify();
  }

  /** Whether the service accepts this order; true while that is unknown. */
  offers(what: string): boolean {
    return this.offered === null || this.offered.has(what);
  }

  /** Whether the service has announced that it accepts this order. */
  knows(what: string): boolean {
    return this.offered?.has(what) ?? false;
  }

  can(what: string): boolean {
    return this.may_write && this.connected && this.offers(what);
  }

  on_change(listener: () => void): void {
    this.listeners.push(listener);
  }

  private notify(): void {
    for (const listener of this.listeners) listener();
  }
}
