// The page's copy of the service's state: values, and tables kept current by deltas.
import {
  tableNames,
  TableMessage,
  TableName,
  Tables,
  ValueMessage,
  ValueName,
  Values,
} from "./protocol";

/** Changes that one message makes to a table. */
export interface Change {
  set: string[];
  gone: string[];
  all: boolean; // true for a snapshot: keys that are not in `set` are removed, too
}

type TableListener = (change: Change) => void;

export class Channels {
  private readonly values: { [Name in ValueName]?: Values[Name] | null } = {};
  // Time at which the service last received a value, by the clock of this page.
  private readonly heard_ms = new Map<string, number>();
  // The values received over this connection.
  private readonly live = new Set<ValueName>();
  private readonly tables = new Map<TableName, Map<string, unknown>>();
  private readonly versions = new Map<TableName, number>();
  private readonly value_listeners = new Map<ValueName, (() => void)[]>();
  private readonly unconfirmed = new Set<string>();
  private readonly table_listeners = new Map<TableName, TableListener[]>();

  constructor() {
    for (const name of tableNames) this.tables.set(name, new Map());
  }

  /** The newest value; null if there is none. */
  value<Name extends ValueName>(name: Name): Values[Name] | null {
    return (this.values[name] as Values[Name] | undefined) ?? null;
  }

  /** Milliseconds since the service last received a value; null if there is none. */
  age_ms(name: ValueName): number | null {
    const heard_ms = this.heard_ms.get(name);
    if (heard_ms === undefined || this.value(name) === null) return null;
    return performance.now() - heard_ms;
  }

  table<Name extends TableName>(name: Name): ReadonlyMap<string, Tables[Name]> {
    return this.tables.get(name) as ReadonlyMap<string, Tables[Name]>;
  }

  /** Versions of the tables of this page; the service sends the changes since then. */
  held(): Record<string, number> {
    return Object.fromEntries(this.versions);
  }

  on_value(names: ValueName[], listener: () => void): void {
    for (const name of names) {
      this.value_listeners.set(name, [...(this.value_listeners.get(name) ?? []), listener]);
    }
  }

  on_table<Name extends TableName>(name: Name, listener: TableListener): void {
    this.table_listeners.set(name, [...(this.table_listeners.get(name) ?? []), listener]);
  }

  /** Applies a message of a channel; false for a delta from a version that the page lacks. */
  apply(message: ValueMessage | TableMessage): boolean {
    this.unconfirmed.delete(message.channel);
    if ("from" in message) return this.apply_table(message);
    (this.values as Record<string, unknown>)[message.channel] = message.value;
    this.note_age(message);
    for (const listener of this.value_listeners.get(message.channel) ?? []) listener();
    return true;
  }

  /** Forgets momentary values; keeps the map and the tables, which later deltas continue. */
  forget_moment(): void {
    for (const name of Object.keys(this.values) as ValueName[]) {
      if (name !== "map") this.apply({ channel: name, version: 0, value: null });
    }
    this.heard_ms.clear();
    this.live.clear();
  }

  // The first value of a connection may be old; `time`, which arrives earlier, gives its age.
  private note_age(message: ValueMessage): void {
    const now_ms = performance.now();
    const name = message.channel;
    if (name === "time") {
      const ages_s = (message.value as Values["time"] | null)?.ages_s ?? {};
      for (const [heard, age_s] of Object.entries(ages_s)) {
        this.heard_ms.set(heard, now_ms - 1000 * age_s);
      }
    } else if (this.live.has(name) || !this.heard_ms.has(name)) {
      this.heard_ms.set(name, now_ms);
    }
    this.live.add(name);
  }

  /** Prepares for a new service, which has version numbers of its own. */
  begin_anew(): void {
    this.versions.clear();
    for (const name of [...tableNames, "map"]) this.unconfirmed.add(name);
  }

  /** Forgets all that was not sent since begin_anew(), because the new service does not have it. */
  drop_unconfirmed(): void {
    for (const name of this.unconfirmed) {
      if (name === "map") {
        this.apply({ channel: name, version: 0, value: null });
        continue;
      }
      this.tables.get(name as TableName)?.clear();
      const change = { set: [], gone: [], all: true };
      for (const listener of this.table_listeners.get(name as TableName) ?? []) listener(change);
    }
    this.unconfirmed.clear();
  }

  private apply_table(message: TableMessage): boolean {
    const table = this.tables.get(message.channel);
    if (!table) return true; // a newer service may have tables that this page does not know
    const all = message.from === 0;
    if (!all && message.from !== this.versions.get(message.channel)) return false;
    if (all) table.clear();
    for (const key of message.gone) table.delete(key);
    for (const [key, value] of Object.entries(message.set)) table.set(key, value);
    this.versions.set(message.channel, message.version);
    const change = { set: Object.keys(message.set), gone: message.gone, all };
    for (const listener of this.table_listeners.get(message.channel) ?? []) listener(change);
    return true;
  }
}
