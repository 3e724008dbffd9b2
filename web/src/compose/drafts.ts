// Texts that are being written, kept in this browser until they are deployed or thrown away.
const prefix = "docent.draft.";

export interface Draft {
  text: string;
  savedMs: number;
  base: string; // the text that the draft began with, to tell whether it differs
}

export function loadDraft(name: string): Draft | null {
  try {
    const stored = JSON.parse(localStorage.getItem(prefix + name) ?? "null") as Partial<Draft> | null;
    return stored && typeof stored.text === "string" ? { text: stored.text, savedMs: Number(stored.savedMs ?? 0), base: String(stored.base ?? "") } : null;
  } catch {
    return null;
  }
}
export function saveDraft(name: string, text: string, base: string): boolean {
  try {
    localStorage.setItem(prefix + name, JSON.stringify({ text, base, savedMs: Date.now() } satisfies Draft));
    return true;
  } catch {
    return false; // the browser's storage is full or closed
  }
}
export function dropDraft(name: string) {
  localStorage.removeItem(prefix + name);
}
export function listDrafts(): { name: string; draft: Draft }[] {
  return Object.keys(localStorage)
    .filter((key) => key.startsWith(prefix))
    .flatMap((key) => {
      const name = key.slice(prefix.length);
      const draft = loadDraft(name);
      return draft ? [{ name, draft }] : [];
    })
    .sort((a, b) => b.draft.savedMs - a.draft.savedMs);
}

// Tells when another tab writes the draft of the same name.
export function watchDraft(name: string, onOther: (draft: Draft | null) => void): () => void {
  const listener = (event: StorageEvent) => {
    if (event.key === prefix + name) onOther(loadDraft(name));
  };
  window.addEventListener("storage", listener);
  return () => window.removeEventListener("storage", listener);
}
