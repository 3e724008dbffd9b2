// The text of a document by its name: the draft of this browser, else the one on the server, else what is deployed.
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { loadDraft } from "../flow/drafts";
import { keepSeen, readServerDraft } from "./server_drafts";

export interface LiveVersion {
  number: number; // of the deployment
  version: string; // the document's own
  timeUs: bigint; // when it was deployed
  text: string;
}
export interface Loaded {
  text: string | null; // null: nothing of this name is there
  live: LiveVersion | null; // what the server runs; null: nothing, or it does not say
  base: string | null; // the deployed text that `text` began from; null: none was deployed
  hidden: boolean; // it is deployed, and the server can't give its text
  error: PlainError | null;
}

export async function loadDocument(name: string): Promise<Loaded> {
  const draft = loadDraft(name);
  let versions: readonly LiveVersion[] = [];
  let live: LiveVersion | null = null;
  let hidden = false;
  let error: PlainError | null = null;
  try {
    // Of what was never deployed, the server has no versions to tell.
    if (!draft || draft.base !== "" || (await isDeployed(name)))
      versions = (await workflows.listVersions({ workflow: name, withTexts: true })).versions;
    live = liveOf(versions);
  } catch (failure) {
    const words = plain(failure);
    if (words.kind === "unable") hidden = await isDeployed(name).catch(() => false);
    else if (words.kind !== "missing") error = words;
  }
  const kept = draft ? null : await readServerDraft(name).catch(() => null);
  if (kept) keepSeen(name, kept.saved, kept.text);
  const base = draft
    ? draft.base || null
    : kept
      ? kept.base || baseAt(versions, Date.parse(kept.saved))
      : (live?.text ?? null);
  return { text: draft?.text ?? kept?.text ?? live?.text ?? null, live, base, hidden, error };
}

// The version that new runs begin with; of a workflow that is no longer deployed, its last one.
export function liveOf<V extends LiveVersion>(
  versions: readonly (V & { live?: boolean })[],
): LiveVersion | null {
  const live = versions.find((v) => v.live) ?? versions.at(-1);
  return live && live.text
    ? { number: live.number, version: live.version, timeUs: live.timeUs, text: live.text }
    : null;
}
// The text that was deployed at a time. Of a draft that does not say what it began from.
export function baseAt(versions: readonly LiveVersion[], ms: number): string | null {
  return versions.findLast((v) => Number(v.timeUs) / 1000 <= ms)?.text ?? null;
}

// Throws what is wrong with the call.
export async function isDeployed(name: string, signal?: AbortSignal): Promise<boolean> {
  return (await workflows.list({}, signal ? { signal } : {})).workflows.some((w) => w.name === name);
}
