// The text of a document by its name: the draft of this browser, else the one on the server, else what is deployed.
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { loadDraft } from "./drafts";
import { keepSeen, readServerDraft } from "./server_drafts";

export interface Loaded {
  text: string | null; // null: nothing of this name is there
  deployed: string | null; // what the server runs; null: nothing, or it does not say
  hidden: boolean; // it is deployed, and the server can't give its text
  error: PlainError | null;
}

export async function loadDocument(name: string): Promise<Loaded> {
  const draft = loadDraft(name);
  let deployed: string | null = null;
  let hidden = false;
  let error: PlainError | null = null;
  try {
    const reply = await workflows.listVersions({ workflow: name, withTexts: true });
    deployed = (reply.versions.find((v) => v.live) ?? reply.versions.at(-1))?.text ?? null;
  } catch (failure) {
    const words = plain(failure);
    if (words.kind === "unable") hidden = await isDeployed(name);
    else if (words.kind !== "missing") error = words;
  }
  const kept = draft ? null : await readServerDraft(name).catch(() => null);
  if (kept) keepSeen(name, kept.saved, kept.text);
  return { text: draft?.text ?? kept?.text ?? deployed, deployed, hidden, error };
}

async function isDeployed(name: string): Promise<boolean> {
  try {
    return (await workflows.list({})).workflows.some((w) => w.name === name);
  } catch {
    return false;
  }
}
