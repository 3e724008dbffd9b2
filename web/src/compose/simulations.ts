// The document that is open, simulated: run on the facts of now with simulated robots, and with what is told meanwhile. Once it was
// asked for, it is run again after each edit.
import { create } from "@bufbuild/protobuf";
import { useEffect, useRef, useState } from "react";
import { replays } from "../api/client";
import { plain, sentence } from "../api/errors";
import { QuadSchema } from "../gen/docent/v1/term_pb";
import type { SimulateReply } from "../gen/docent/v1/replays_pb";
import { startArguments } from "../flow/start_dialog";
import type { Findings } from "./findings";
import { inOrder, type Telling } from "./simulation";
import { restMs } from "./trials";

interface Asked {
  text: string;
  flow: string;
  told: readonly Telling[];
  values: Readonly<Record<string, string>>; // of variables at the begin, as they are written
}
export interface Simulation extends Asked {
  reply: SimulateReply;
}

export function useSimulation(
  workflow: string,
  text: string,
  flow: string,
  findings: Findings,
  prefixes: ReadonlyMap<string, string>,
) {
  const [told, setTold] = useState<readonly Telling[]>([]);
  const [values, setValues] = useState<Asked["values"]>({});
  const [shown, setShown] = useState<Simulation | null>(null);
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState("");
  const asking = useRef<AbortController | null>(null);

  const simulate = async (change: Partial<Asked> = {}): Promise<boolean> => {
    const asked: Asked = { text, flow, told, values, ...change };
    asking.current?.abort();
    const abort = (asking.current = new AbortController());
    setBusy(true);
    try {
      const reply = await replays.simulate(
        {
          name: `${workflow}.cawl.xml`,
          cawl: asked.text,
          flow: asked.flow,
          arguments: startArguments(asked.values, prefixes),
          told: inOrder(asked.told).map((t) => ({
            afterS: t.afterS,
            [t.remove ? "remove" : "add"]: [create(QuadSchema, t.quad)],
          })),
        },
        { signal: abort.signal },
      );
      if (abort.signal.aborted) return false;
      setShown({ ...asked, reply });
      setError("");
      setBusy(false);
      return true;
    } catch (failure) {
      if (abort.signal.aborted || plain(failure).kind === "cancelled") return false;
      setError(failure instanceof RangeError ? failure.message : sentence(failure));
      setBusy(false);
      return false;
    }
  };
  useEffect(() => () => asking.current?.abort(), []);

  const faulty = findings.list.some((f) => f.error);
  const good = findings.of === text && !faulty && !findings.error;
  const old = shown !== null && (shown.text !== text || shown.flow !== flow);
  const latest = useRef(simulate);
  latest.current = simulate;
  useEffect(() => {
    if (!old || !good) return;
    const timer = window.setTimeout(() => void latest.current(), restMs);
    return () => window.clearTimeout(timer);
  }, [text, flow, good, old]);

  const retell = (list: readonly Telling[]) => (setTold(list), void simulate({ told: list }));
  return {
    shown,
    old,
    busy,
    error,
    faulty,
    told,
    values,
    setValues,
    simulate,
    tell: (telling: Telling) => retell([...told, telling]),
    untell: (telling: Telling) => retell(told.filter((t) => t !== telling)),
  };
}
export type Simulations = ReturnType<typeof useSimulation>;
