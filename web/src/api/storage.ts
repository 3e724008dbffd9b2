// What this browser keeps, for the whole app. Where its storage is closed (cookies are blocked) or full, things last as long as
// the page: every access may throw, so nothing else in the app touches the browser's storage.
export interface Kept {
  getItem(key: string): string | null;
  setItem(key: string, value: string): boolean; // false: it lasts as long as the page
  removeItem(key: string): void;
  keys(): string[];
  open(): boolean; // whether the browser keeps anything at all
}

export function keptIn(storage: () => Storage): Kept {
  const here = new Map<string, string>(); // what the browser did not take
  const attempt = <T>(what: (real: Storage) => T, instead: T): T => {
    try {
      return what(storage());
    } catch {
      return instead;
    }
  };
  return {
    getItem: (key) => here.get(key) ?? attempt((real) => real.getItem(key), null),
    setItem: (key, value) => {
      const kept = attempt((real) => (real.setItem(key, value), true), false);
      if (kept) here.delete(key);
      else here.set(key, value);
      return kept;
    },
    removeItem: (key) => {
      here.delete(key);
      attempt((real) => real.removeItem(key), undefined);
    },
    keys: () => [...new Set([...attempt((real) => Object.keys(real), []), ...here.keys()])],
    open: () => attempt((real) => (real.getItem(""), true), false),
  };
}

export const kept = keptIn(() => globalThis.localStorage); // of all tabs, until it is removed
export const keptInTab = keptIn(() => globalThis.sessionStorage); // of this tab, over a reload
