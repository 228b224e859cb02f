// The language of the page: the one that was chosen, or that of the browser.
const key = "topogeo-language";

/** One of `known`; the first one if neither is. */
export function stored_language(known: string[]): string {
  if (typeof localStorage === "undefined") return known[0];
  const chosen = localStorage.getItem(key) ?? navigator.language.slice(0, 2);
  return known.includes(chosen) ? chosen : known[0];
}

/** Opens the page anew in this language. */
export function choose_language(language: string): void {
  localStorage.setItem(key, language);
  location.reload();
}
