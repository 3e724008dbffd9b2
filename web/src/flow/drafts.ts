// Texts that are being written, kept in this browser until they are deployed or thrown away. Where the browser does not keep
// them, they last as long as the page, and leaving it asks first.
import { kept } from "../api/storage";

const prefix = "docent.draft.";

export interface Draft {
  text: string;
  savedMs: number;
  base: string; // the deployed text that the draft began from; empty: none was deployed
}

export function loadDraft(name: string): Draft | null {
  try {
    const stored = JSON.parse(kept.getItem(prefix + name) ?? "null") as Partial<Draft> | null;
    return stored && typeof stored.text === "string"
      ? { text: stored.text, savedMs: Number(stored.savedMs ?? 0), base: String(stored.base ?? "") }
      : null;
  } catch {
    return null;
  }
}
// False: it lasts as long as the page.
export function saveDraft(name: string, text: string, base: string): boolean {
  const saved = kept.setItem(
    prefix + name,
    JSON.stringify({ text, base, savedMs: Date.now() } satisfies Draft),
  );
  if (saved) unkept.delete(name);
  else unkept.add(name);
  if (unkept.size === 1 && !saved) window.addEventListener("beforeunload", askBeforeLeaving); // once, however often
  return saved;
}
export function dropDraft(name: string) {
  unkept.delete(name);
  kept.removeItem(prefix + name);
}
export function listDrafts(): { name: string; draft: Draft }[] {
  return kept
    .keys()
    .filter((key) => key.startsWith(prefix))
    .flatMap((key) => {
      const name = key.slice(prefix.length);
      const draft = loadDraft(name);
      return draft ? [{ name, draft }] : [];
    })
    .sort((a, b) => b.draft.savedMs - a.draft.savedMs);
}

const unkept = new Set<string>(); // names of drafts that a reload would lose
export const isUnkept = (name: string) => unkept.has(name);
export function askBeforeLeaving(event: Event) {
  if (unkept.size > 0) event.preventDefault();
}

// Tells when another tab writes the draft of the same name.
export function watchDraft(name: string, onOther: (draft: Draft | null) => void): () => void {
  const listener = (event: StorageEvent) => {
    if (event.key === prefix + name) onOther(loadDraft(name));
  };
  window.addEventListener("storage", listener);
  return () => window.removeEventListener("storage", listener);
}
