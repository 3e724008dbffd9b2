// The version of the open document that the server runs: looked at all the time, and said where it is not the one that the text
// began from.
import { useEffect, useRef } from "react";
import { workflows } from "../api/client";
import { plain } from "../api/errors";
import { usePoll } from "../api/poll";
import { clockMinutes, timeTitle } from "../api/times";
import { type DraftSync, versionWords } from "./draft_sync";
import { isDeployed, liveOf, type LiveVersion } from "./load_document";

const lookMs = 3000;

// Undefined: the server does not say. Texts are asked for only where another version is live.
export async function askLive(
  name: string,
  known: LiveVersion | null,
  signal?: AbortSignal,
): Promise<LiveVersion | null> {
  const options = signal ? { signal } : {};
  if (!known && !(await isDeployed(name, signal))) return null; // to ask for versions of what has none is an error
  const { versions } = await workflows.listVersions({ workflow: name }, options);
  const now = versions.find((v) => v.live) ?? versions.at(-1);
  if (!now || (known && now.number === known.number && now.timeUs === known.timeUs)) return null;
  return liveOf((await workflows.listVersions({ workflow: name, withTexts: true }, options)).versions);
}

// The number of the version that new runs start with; 0: none does. Undefined: the server does not say.
export async function liveNumber(name: string): Promise<number | undefined> {
  try {
    if (!(await isDeployed(name))) return 0;
    return (await workflows.listVersions({ workflow: name })).versions.find((v) => v.live)?.number ?? 0;
  } catch (failure) {
    return plain(failure).kind === "missing" ? 0 : undefined;
  }
}

export function useLiveVersion(
  name: string,
  sync: DraftSync,
): { live: LiveVersion | null; deployed: (text: string, version: string) => void } {
  sync.turns.use();
  const generation = useRef(0); // an answer from before an own deployment is old
  const polled = usePoll(
    `live version ${name}`,
    async (signal) => {
      const asked = generation.current;
      const live = await askLive(name, sync.live, signal);
      return { asked, live };
    },
    lookMs,
  );
  useEffect(() => {
    if (polled.data?.live && polled.data.asked === generation.current) sync.sees(polled.data.live);
  }, [polled.data, sync]);
  return {
    live: sync.live,
    deployed: (text, version) => (generation.current++, sync.isDeployed(text, version)),
  };
}

// "Version 1.2 was deployed at 18:20 after you began."
export function behindWords(live: LiveVersion, base: string | null): string {
  const today = new Date(Number(live.timeUs / 1000n)).toDateString() === new Date().toDateString();
  const when = live.timeUs > 0n ? ` ${today ? "at" : "on"} ${clockMinutes(live.timeUs)}` : "";
  return base === null
    ? `${versionWords(live)} was deployed${when}, and this text did not begin from it.`
    : `${versionWords(live)} was deployed${when} after you began.`;
}

export function BehindBar({ sync }: { sync: DraftSync }) {
  const { live } = sync;
  if (!live || !sync.behind) return null;
  return (
    <div className="stale" role="alert">
      <span title={live.timeUs > 0n ? timeTitle(live.timeUs) : undefined}>
        {behindWords(live, sync.base)} Deploying this text takes it back.
      </span>
      <BehindChoices sync={sync} />
    </div>
  );
}
export function BehindChoices({ sync }: { sync: DraftSync }) {
  return (
    <>
      {sync.together() !== null && (
        <button
          className="button small"
          title="What was changed here, and what was deployed"
          onClick={() => sync.putTogether()}
        >
          Put both together
        </button>
      )}
      <button className="button small" title="Undo brings this text back" onClick={() => sync.takeLive()}>
        Take the deployed text
      </button>
    </>
  );
}

// Where the browser does not keep the text.
export function UnkeptBar({ sync, full }: { sync: DraftSync; full: boolean }) {
  if (sync.isKept) return null;
  return (
    <div className="stale" role="status">
      {full
        ? "The browser’s storage is full: this draft is not kept."
        : "This browser keeps nothing: drafts are not kept."}{" "}
      Save the text as a file (Ctrl-S) or on the server (Ctrl-Shift-S) before you leave the page.
    </div>
  );
}
