// Texts of the visitors' page: one JSON file a language in words/. A language that is added there is offered.
import { createContext, useContext } from "react";
import english from "./words/en.json";

export type Word = keyof typeof english;
export type Texts = Record<Word, string>;
export type Say = (word: Word, values?: Record<string, string | number>) => string;

const files = import.meta.glob<Texts>("./words/*.json", { eager: true, import: "default" });
export const languages: ReadonlyMap<string, Texts> = new Map(
  Object.entries(files).map(([path, texts]) => [/(\w+)\.json$/.exec(path)?.[1] ?? "", texts]),
);

// The first of the wanted languages that is there, "de-AT" as "de"; else English.
export function chooseLanguage(wanted: readonly string[]): string {
  return wanted.map((tag) => tag.toLowerCase().split("-")[0] ?? "").find((tag) => languages.has(tag)) ?? "en";
}

export function sayIn(language: string): Say {
  const texts = languages.get(language) ?? english;
  return (word, values = {}) =>
    (texts[word] ?? english[word]).replace(/\{(\w+)\}/g, (whole, name: string) =>
      String(values[name] ?? whole),
    );
}

export const LanguageContext = createContext<{ language: string; say: Say }>({
  language: "en",
  say: sayIn("en"),
});
export function useWords() {
  return useContext(LanguageContext);
}
