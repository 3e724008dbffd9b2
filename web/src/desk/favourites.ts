// What the front desk starts by one touch: workflows and robot services, some with values that are given already. Kept in this
// browser, and written into an address to hand them on.
import type { Kept } from "../api/storage";
import { words } from "../cawl/names";

export interface Favourite {
  kind: "workflow" | "service";
  name: string;
  flow: string; // of a workflow; empty: the one that it starts by itself, or its only one
  title: string; // what stands on the button; empty: the name in words
  values: Readonly<Record<string, string>>; // given already, as they are written: "expo:B05"
}
const key = "docent.desk";
export const mostFavourites = 60;

// "workflow:BoothGuide;flow=Short;title=Guide;$booth=expo:B05", each part percent-encoded where it has to be.
export function favouriteText(f: Favourite): string {
  const parts = [`${f.kind}:${part(f.name)}`];
  if (f.flow) parts.push(`flow=${part(f.flow)}`);
  if (f.title) parts.push(`title=${part(f.title)}`);
  for (const name of Object.keys(f.values).sort())
    if (f.values[name]) parts.push(`$${part(name)}=${part(f.values[name] ?? "")}`);
  return parts.join(";");
}
function part(text: string): string {
  return text.replace(/[%;=]/g, encodeURIComponent);
}

// Null: it is not the text of a favourite.
export function readFavourite(text: string): Favourite | null {
  const [head = "", ...rest] = text.split(";");
  const match = /^(workflow|service):(.+)$/.exec(head);
  if (!match) return null;
  const favourite: Favourite = {
    kind: match[1] as Favourite["kind"],
    name: plain(match[2] ?? ""),
    flow: "",
    title: "",
    values: {},
  };
  const values: Record<string, string> = {};
  for (const one of rest) {
    const at = one.indexOf("=");
    if (at <= 0) continue;
    const [name, value] = [plain(one.slice(0, at)), plain(one.slice(at + 1))];
    if (name === "flow" || name === "title") favourite[name] = value;
    else if (name.startsWith("$")) values[name.slice(1)] = value;
  }
  return { ...favourite, values };
}
function plain(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

export function readFavourites(search: string): Favourite[] {
  return new URLSearchParams(search)
    .getAll("f")
    .flatMap((text) => readFavourite(text) ?? [])
    .slice(0, mostFavourites);
}
export function favouritesSearch(favourites: readonly Favourite[]): string {
  const search = new URLSearchParams(favourites.map((f) => ["f", favouriteText(f)])).toString();
  return search && `?${search}`;
}

export function keptFavourites(storage: Pick<Kept, "getItem">): Favourite[] {
  try {
    const stored = JSON.parse(storage.getItem(key) ?? "[]") as unknown;
    return Array.isArray(stored)
      ? stored.flatMap((text) => (typeof text === "string" ? (readFavourite(text) ?? []) : []))
      : [];
  } catch {
    return [];
  }
}
// False: this browser keeps nothing.
export function keepFavourites(favourites: readonly Favourite[], storage: Pick<Kept, "setItem">): boolean {
  return storage.setItem(key, JSON.stringify(favourites.slice(0, mostFavourites).map(favouriteText)));
}

export function titleOf(favourite: Favourite): string {
  return favourite.title || words(favourite.name);
}
