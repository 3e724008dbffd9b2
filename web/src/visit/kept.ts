// Answers that are kept in this browser: shown at once, and as long as there is no network.
import { useEffect, useState } from "react";
import { type Polled, usePoll } from "../api/poll";
import { kept as storage } from "../api/storage";

export function useKept<T>(
  name: string,
  ask: (signal: AbortSignal) => Promise<T>,
  everyMs: number,
): Polled<T> {
  const [kept] = useState<T | undefined>(() => {
    try {
      return (JSON.parse(storage.getItem(`docent.visit.${name}`) ?? "null") as T | null) ?? undefined;
    } catch {
      return undefined;
    }
  });
  const polled = usePoll(name, ask, everyMs);
  useEffect(() => {
    if (polled.data === undefined) return;
    storage.setItem(`docent.visit.${name}`, JSON.stringify(polled.data));
  }, [polled.data, name]);
  return { ...polled, data: polled.data ?? kept };
}
