// What the live runs wait for, asked of the server again and again.
import { useEffect, useState } from "react";
import { useShown } from "../api/as_of";
import { workflows } from "../api/client";
import type { Run, Wait } from "../gen/docent/v1/workflows_pb";
import { isLive } from "../ui/states";

const asked = 60; // runs that are explained at a time, the oldest first

export function useWaits(runs: readonly Run[]) {
  const live = runs.filter((r) => !r.parent && isLive(r.state));
  const ids = [...live]
    .sort((a, b) => Number(a.startedUs - b.startedUs))
    .slice(0, asked)
    .map((r) => r.id);
  const polled = useShown(
    ids.length > 0 ? `waits ${ids.join(" ")}` : "",
    async (asOf, signal) =>
      new Map(
        await Promise.all(
          ids.map(async (run): Promise<[string, readonly Wait[]]> => [
            run,
            (await workflows.explain({ run, asOf }, { signal }).catch(() => ({ waits: [] }))).waits,
          ]),
        ),
      ),
    2000,
  );
  const [last, setLast] = useState<ReadonlyMap<string, readonly Wait[]>>(new Map());
  useEffect(() => void (polled.data && setLast(polled.data)), [polled.data]);
  return { waits: last, again: polled.again, left: Math.max(0, live.length - asked) };
}
