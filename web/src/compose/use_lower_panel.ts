// The panel below the canvas: trials on past runs, or the simulation; and the states of steps that it shows on the canvas.
import { useEffect, useEffectEvent, useMemo, useRef, useState } from "react";
import { type StepTrial, stepTrials, type Trials } from "./trials";

type Which = "trials" | "simulate";

// `begun`: the run of the address. It is tried once, when it is in the list.
export function useLowerPanel(trials: Trials, begun: string) {
  const [panel, setPanel] = useState<Which | "">(begun === "" ? "" : "trials");
  const [tried, setTried] = useState(begun); // the run whose trial the canvas shows
  const wanted = useRef(begun);
  const ready = wanted.current !== "" && trials.list.some((t) => t.run === wanted.current);
  const attemptWanted = useEffectEvent(() => {
    void trials.attempt(wanted.current);
    wanted.current = "";
  });
  useEffect(() => {
    if (ready) attemptWanted();
  }, [ready]);
  const reply = trials.list.find((t) => t.run === tried)?.reply ?? null;
  const trial = useMemo(() => (reply && panel === "trials" ? stepTrials(reply) : null), [reply, panel]);
  const [simulated, setSimulated] = useState<ReadonlyMap<string, StepTrial> | null>(null); // at the moment that is shown
  return {
    panel,
    toggle: (which: Which) => setPanel(panel === which ? "" : which),
    tried,
    setTried,
    states: trial ?? simulated,
    setSimulated,
  };
}
