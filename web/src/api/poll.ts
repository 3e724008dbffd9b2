// Asks again and again while the view is seen: what was asked last stays shown when an answer fails, and the error is beside it.
import { useEffect, useRef, useState } from "react";
import { plain, type PlainError } from "./errors";

export interface Polled<T> {
  data: T | undefined;
  error: PlainError | undefined;
  again: () => void; // asks now
}

// `ask` is asked every `everyMs` after its last answer, and at once when `key` changes. An empty key asks nothing.
export function usePoll<T>(
  key: string,
  ask: (signal: AbortSignal) => Promise<T>,
  everyMs: number,
): Polled<T> {
  const [state, setState] = useState<{ key: string; data?: T; error?: PlainError }>({ key });
  const latest = useRef(ask);
  latest.current = ask;
  const kick = useRef<() => void>(() => undefined);
  useEffect(() => {
    if (key === "") return;
    const abort = new AbortController();
    let timer: number | undefined;
    let running = false;
    let wanted = false; // asked for while an answer was on its way, which may be older
    const turn = async () => {
      if (running) {
        wanted = true;
        return;
      }
      running = true;
      wanted = false;
      window.clearTimeout(timer);
      try {
        const data = await latest.current(abort.signal);
        if (!abort.signal.aborted) setState({ key, data });
      } catch (error) {
        const words = plain(error);
        if (!abort.signal.aborted)
          setState((before) => ({ ...(before.key === key ? before : { key }), error: words }));
      }
      running = false;
      if (!abort.signal.aborted)
        timer = window.setTimeout(
          () => void turn(),
          wanted ? 0 : document.hidden ? Math.max(everyMs, 5000) : everyMs,
        );
    };
    kick.current = () => void turn();
    const seen = () => !document.hidden && void turn();
    document.addEventListener("visibilitychange", seen);
    void turn();
    return () => {
      abort.abort();
      window.clearTimeout(timer);
      document.removeEventListener("visibilitychange", seen);
    };
  }, [key, everyMs]);
  const mine = state.key === key;
  return {
    data: mine ? state.data : undefined,
    error: mine ? state.error : undefined,
    again: () => kick.current(),
  };
}
