// Reasons and messages of services, which are English, in the language of the page.
import { sentence } from "./format";
import { spanish_reasons } from "./spanish_reasons";
import { texts } from "./texts";

interface Pattern {
  english: RegExp;
  translated: string;
}

/** Tables by language: English texts with {} for their parts, and translations with {1}, {2}. */
const tables: Record<string, Pattern[]> = { es: spanish_reasons.map(([from, to]) => pattern_of(from, to)) };

function pattern_of(english: string, translated: string): Pattern {
  const parts = english.split("{}").map((part) => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  return { english: new RegExp(`^${parts.join("(.+?)")}\\.?$`, "s"), translated };
}

/** A text of a service in a language; unchanged if the language has no translation of it. */
export function translated(text: string, language = texts.language): string {
  const known = text === "" ? undefined : tables[language];
  for (const { english, translated: to } of known ?? []) {
    const found = english.exec(text);
    if (!found) continue;
    return to.replace(/\{(\d)\}/g, (_, part: string) => translated(found[Number(part)] ?? "", language));
  }
  return text;
}

/** A message of a service as a sentence. */
export function reason(text: string): string {
  return sentence(translated(text));
}
