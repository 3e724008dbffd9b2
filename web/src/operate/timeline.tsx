// What happened in a run, in order.
import { useEffect, useState } from "react";
import { Code, ConnectError } from "@connectrpc/connect";
import { workflowStreams } from "../api/client";
import { type RunEvent, RunEventSchema } from "../gen/docent/v1/workflows_pb";
import { fromJson, type JsonValue } from "@bufbuild/protobuf";
import { live } from "../api/live";
import type { Names } from "../api/prefixes";
import { showTime, usePast } from "../api/past";
import { clock, look, timeTitle } from "../ui/states";
import { eventsInWords } from "./timeline_words";

const kept = 2000;

// Events of a run from its beginning on, or from now on where the server does not keep them.
export function useRunEvents(run: string): { events: RunEvent[]; whole: boolean } {
  const [state, setState] = useState<{ events: RunEvent[]; whole: boolean }>({ events: [], whole: true });
  useEffect(() => {
    setState({ events: [], whole: true });
    const take = (event: RunEvent) =>
      setState((before) => ({ ...before, events: [...before.events.slice(-kept), event] }));
    const notWhole = () => setState((before) => ({ ...before, whole: false }));
    return live.state === "none" ? streamEvents(run, take, notWhole) : followEvents(run, take, notWhole);
  }, [run]);
  return state;
}

function followEvents(run: string, take: (event: RunEvent) => void, notWhole: () => void): () => void {
  const onMessage = (message: JsonValue) =>
    take(fromJson(RunEventSchema, message, { ignoreUnknownFields: true }));
  let stop = live.follow({
    call: "docent.v1.Workflows/Watch",
    request: { run, after: "1" },
    everyMs: undefined,
    onMessage,
    onEnd: (failure) => {
      if (failure?.code !== "out_of_range") return;
      notWhole();
      stop = live.follow({
        call: "docent.v1.Workflows/Watch",
        request: { run },
        everyMs: undefined,
        onMessage,
        onEnd: () => undefined,
      });
    },
  });
  return () => stop();
}

// Of a server without live connections. A stream that breaks goes on after the events that are there.
function streamEvents(run: string, take: (event: RunEvent) => void, notWhole: () => void): () => void {
  const abort = new AbortController();
  let newest = 0n; // revision of the newest event
  let known = 0; // events of that revision
  const stream = async (after: bigint): Promise<void> => {
    let again = newest > 0n ? known : 0; // events of the newest revision that come a second time
    try {
      for await (const event of workflowStreams.watch(
        { run, after },
        { signal: abort.signal, timeoutMs: 0 },
      )) {
        if (event.revision === newest && again-- > 0) continue;
        known = event.revision === newest ? known + 1 : 1;
        newest = event.revision;
        take(event);
      }
    } catch (error) {
      if (!abort.signal.aborted && ConnectError.from(error).code === Code.OutOfRange && after > 0n) {
        notWhole();
        return stream(0n);
      }
    }
    await new Promise((done) => window.setTimeout(done, 2000));
    if (!abort.signal.aborted) return stream(newest > 0n ? newest - 1n : 1n);
  };
  void stream(1n);
  return () => abort.abort();
}

export function Timeline({
  run,
  names,
  picked,
  onPick,
}: {
  run: string;
  names: Names;
  picked: string;
  onPick: (node: string) => void;
}) {
  const { events, whole } = useRunEvents(run);
  const at = usePast();
  const until = at === null ? events : events.filter((e) => Number(e.timeUs) / 1000 <= at);
  const said = eventsInWords(until, names);
  const shown = until
    .map((event, i) => ({ event, words: said[i] }))
    .filter(({ event, words }) => words && (!picked || event.node === picked));
  if (shown.length === 0)
    return (
      <p className="faint small" style={{ padding: "var(--space-5) var(--space-7)" }}>
        {until.length === 0 && at !== null
          ? "Nothing had happened yet."
          : events.length === 0
            ? "What happens from now on is listed here."
            : `Nothing of ${picked} yet.`}
      </p>
    );
  return (
    <ol className="timeline">
      {!whole && <li className="faint small">What was before is no longer kept.</li>}
      {shown.map(({ event: e, words: line }, i) => {
        const { icon: Icon, tone } = look(e.to);
        return (
          <li key={i}>
            <span className={`timeline-icon ${tone}`}>
              <Icon size={13} />
            </span>
            <div className="grow">
              <div>
                <button className="timeline-node" onClick={() => onPick(e.node)}>
                  {e.node || "The run"}
                </button>{" "}
                <span className="faint">{line?.words}</span>
              </div>
              {line?.detail && <div className="timeline-detail">{line.detail}</div>}
            </div>
            <button
              className="timeline-time faint number small"
              title={`Show this time: ${timeTitle(e.timeUs)}`}
              onClick={() => showTime(Number(e.timeUs / 1000n) + 1)}
            >
              {clock(e.timeUs)}
            </button>
          </li>
        );
      })}
    </ol>
  );
}
