// Answers that are kept in this browser: shown at once, and as long as there is no network.
import { useEffect, useState } from "react";
import { type Polled, usePoll } from "../api/poll";

export function useKept<T>(name: string, ask: (signal: AbortSignal) => Promise<T>, everyMs: number): Polled<T> {
  const [kept] = useState<T | undefined>(() => {
    try {
      return (JSON.parse(localStorage.getItem(`docent.visit.${name}`) ?? "null") as T | null) ?? undefined;
    } catch {
      return undefined;
    }
  });
  const polled = usePoll(name, ask, everyMs);
  useEffect(() => {
    if (polled.data === undefined) return;
    try {
      localStorage.setItem(`docent.visit.${name}`, JSON.stringify(polled.data));
    } catch {
      // too large for this browser, or it keeps nothing
    }
  }, [polled.data, name]);
  return { ...polled, data: polled.data ?? kept };
}
