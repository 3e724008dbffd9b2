// The draft on the server, beside the one that is open: saving it, and what to do where another browser has saved one.
import { CloudCheck, CloudUpload } from "lucide-react";
import { useCallback, useEffect, useState } from "react";
import { sentence } from "../api/errors";
import { usePoll } from "../api/poll";
import { Time } from "../api/times";
import { useCommands } from "../ui/commands";
import { toast } from "../ui/toasts";
import type { DraftSync } from "./draft_sync";
import { mergeTexts } from "./merge";
import { keepSeen, readServerDraft, seenState, seenText, writeServerDraft } from "./server_drafts";
import type { Session } from "./session";

const lookMs = 5000;

export function useServerDraft(name: string, session: Session, sync: DraftSync) {
  const [seen, setSeen] = useState(() => seenState(name));
  const polled = usePoll(`server draft ${name}`, (signal) => readServerDraft(name, signal), lookMs);
  const [busy, setBusy] = useState(false);
  const there = polled.data ?? null;
  const same = there !== null && there.text === session.written;
  const see = useCallback(
    (saved: string, text: string) => {
      keepSeen(name, saved, text);
      setSeen(saved);
    },
    [name],
  );
  // The same text, whoever has saved it: nothing to choose between.
  useEffect(() => {
    if (same && there.saved !== seen) see(there.saved, there.text);
  }, [same, there, seen, see]);
  const save = async () => {
    setBusy(true);
    try {
      const text = session.written;
      const saved = await writeServerDraft(name, text, sync.base ?? "", seen);
      if (saved) {
        see(saved, text);
        toast(
          "good",
          "The draft is saved on the server",
          "It can be opened in any browser. Nothing is deployed.",
        );
      } else toast("bad", "Somebody else has saved a draft", "Take its text, or keep yours and save again.");
      polled.again();
    } catch (error) {
      toast("bad", "The draft could not be saved on the server", sentence(error));
    }
    setBusy(false);
  };
  useCommands([
    {
      title: "Save the draft on the server",
      group: "Document",
      icon: CloudUpload,
      keys: "Mod+Shift+S",
      inFields: true,
      run: () => void save(),
    },
  ]);
  return {
    name,
    there,
    same,
    busy,
    save,
    newer: there !== null && !same && there.saved !== seen ? there : null,
    see,
  };
}
export type ServerDraftState = ReturnType<typeof useServerDraft>;

export function ServerDraftButton({ draft, dirty }: { draft: ServerDraftState; dirty: boolean }) {
  if (!dirty && !draft.there) return null;
  const Icon = draft.same ? CloudCheck : CloudUpload;
  return (
    <button
      className="button plain wide-only"
      disabled={draft.busy || draft.same}
      title="Save the draft on the server (Ctrl-Shift-S)"
      onClick={() => void draft.save()}
    >
      <Icon size={15} />
      {draft.same ? "Saved" : "Save"}
    </button>
  );
}

export function ServerDraftBar({ draft, session }: { draft: ServerDraftState; session: Session }) {
  const { newer } = draft;
  if (!newer) return null;
  const base = seenText(draft.name);
  const both = base === null ? null : mergeTexts(base, session.written, newer.text);
  return (
    <div className="stale" role="alert">
      Another browser has saved a draft on the server at{" "}
      <Time us={BigInt(Date.parse(newer.saved) || 0) * 1000n} />.
      {both !== null && both !== newer.text && (
        <button
          className="button small"
          onClick={() => (session.mergeIn(both), draft.see(newer.saved, newer.text))}
        >
          Put both together
        </button>
      )}
      <button
        className="button small"
        onClick={() => (session.replaceAll(newer.text), draft.see(newer.saved, newer.text))}
      >
        Take its text
      </button>
      <button className="button small" onClick={() => draft.see(newer.saved, newer.text)}>
        Keep mine
      </button>
    </div>
  );
}
