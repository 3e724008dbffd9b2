// What is selected of the flow that is shown: steps and links. A single step stands in the address; the text shows what is selected.
import { useCallback, useEffect, useEffectEvent, useState } from "react";
import { type ShownFlow, shownFlow } from "../cawl/shown";
import { navigate, paths } from "../ui/router";
import { focusStep } from "./focus_step";
import type { Session } from "./session";

const only = (key: string): ReadonlySet<string> => new Set(key ? [key] : []);

export function useSelection(
  session: Session,
  shown: ShownFlow | null,
  { name, flow, step, via }: { name: string; flow: string; step: string; via: string },
) {
  const [steps, setSteps] = useState(() => only(step));
  const [links, setLinks] = useState(() => only(""));
  const mark = useCallback((stepKeys: Iterable<string>, linkKeys: Iterable<string>) => {
    setSteps(new Set(stepKeys));
    setLinks(new Set(linkKeys));
  }, []);

  const revealStep = useEffectEvent(() => {
    const begun = session.document.flows.flatMap((f) => f.steps).find((s) => s.key === step);
    if (begun) session.reveal(begun.element.from, begun.element.openTo);
  });
  useEffect(() => revealStep(), [session]); // the step of the address, once
  const markStep = useEffectEvent(() => mark(only(step), []));
  useEffect(() => markStep(), [flow]); // another flow of the document
  // What undo or the text has taken away is no longer selected, and is not again when it comes back.
  useEffect(() => {
    const stepKeys = new Set(shown?.steps.map((s) => s.key));
    const linkKeys = new Set(shown?.links.map((l) => l.key));
    if ([...steps].some((key) => !stepKeys.has(key)))
      setSteps(new Set([...steps].filter((key) => stepKeys.has(key))));
    if ([...links].some((key) => !linkKeys.has(key)))
      setLinks(new Set([...links].filter((key) => linkKeys.has(key))));
  }, [shown, steps, links]);

  const select = useCallback(
    (stepKeys: string[], linkKeys: string[], focus = false) => {
      mark(stepKeys, linkKeys);
      const single = stepKeys.length === 1 && linkKeys.length === 0 ? (stepKeys[0] ?? "") : "";
      navigate(paths.compose(name, flow, single, via), true);
      const part = shownFlow(session.document, session.good, flow);
      const element = single
        ? part?.steps.find((s) => s.key === single && !s.stale)?.element
        : linkKeys.length === 1 && stepKeys.length === 0
          ? part?.links.find((l) => l.key === linkKeys[0])?.element
          : undefined;
      if (element && !session.view.hasFocus) session.reveal(element.from, element.openTo);
      if (focus && single) focusStep(single);
    },
    [mark, name, flow, via, session],
  );

  const chosenSteps = shown?.steps.filter((s) => steps.has(s.key) && !s.stale) ?? [];
  const chosenLinks = shown?.links.filter((l) => links.has(l.key) && !l.stale) ?? [];
  return {
    steps,
    links,
    chosenSteps,
    chosenLinks,
    only: chosenSteps.length === 1 && chosenLinks.length === 0 ? chosenSteps[0] : undefined,
    select,
    mark, // without a new address or another place in the text
  };
}
export type Selection = ReturnType<typeof useSelection>;
