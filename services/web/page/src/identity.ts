// This page among others: a secret id, with which its orders are its own, and the operator's name.
const idKey = "topogeo-page";
const nameKey = "topogeo-operator";
const longestName = 24;

export class Identity {
  readonly id: string;
  private own_name: string;

  constructor() {
    this.id = sessionStorage.getItem(idKey) ?? random_digits();
    sessionStorage.setItem(idKey, this.id);
    this.own_name = localStorage.getItem(nameKey) ?? "";
  }

  /** Empty until the operator has chosen one. */
  get name(): string {
    return this.own_name;
  }

  set name(name: string) {
    this.own_name = name.trim().slice(0, longestName);
    localStorage.setItem(nameKey, this.own_name);
  }
}

function random_digits(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
