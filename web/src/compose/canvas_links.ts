// The arrows on the canvas, and how they are selected.
import { type EdgeChange, MarkerType } from "@xyflow/react";
import { useMemo } from "react";
import type { LinkEdgeType } from "../flow/link_edge";
import type { CanvasProps } from "./canvas";

// `hovered`: the key of the link that something is dragged onto.
export function useLinks(props: CanvasProps, hovered: string | null) {
  const { shown, selectedLinks, onQuickAdd } = props;
  const onEdgesChange = (changes: EdgeChange<LinkEdgeType>[]) => {
    const links = new Set(selectedLinks);
    let any = false;
    for (const change of changes)
      if (change.type === "select") {
        any = true;
        if (change.selected) links.add(change.id);
        else links.delete(change.id);
      }
    if (any) props.onSelect([...props.selected], [...links]);
  };

  const byName = useMemo(() => new Map(shown.steps.map((s) => [s.name, s.key])), [shown]);
  const badLinks = useMemo(
    () => new Set(props.findings.filter((f) => f.flow === shown.flow.key && f.link).map((f) => f.link)),
    [props.findings, shown],
  );
  const edges = useMemo(
    () =>
      shown.links.flatMap((link): LinkEdgeType[] => {
        const source = byName.get(link.from);
        const target = byName.get(link.to);
        if (source === undefined || target === undefined) return [];
        const bad = badLinks.has(link.key);
        return [
          {
            id: link.key,
            source,
            target,
            type: "link",
            selected: selectedLinks.has(link.key),
            ariaLabel: `Link from ${link.from} to ${link.to}`,
            className: `${link.kind}${link.stale ? " unmended" : ""}${bad ? " bad" : ""}${hovered === link.key ? " target" : ""}`,
            data: { link, onInsert: (key: string) => onQuickAdd({ link: key }) },
            markerEnd: { type: MarkerType.ArrowClosed, width: 15, height: 15, color: "context-stroke" },
          },
        ];
      }),
    [shown, byName, badLinks, selectedLinks, onQuickAdd, hovered],
  );
  return { edges, onEdgesChange };
}

// The key of the link at a place of the window.
export function linkAt(x: number, y: number): string | null {
  for (const element of document.elementsFromPoint(x, y)) {
    const label = element.closest("[data-link]")?.getAttribute("data-link");
    const edge = element.closest(".react-flow__edge")?.getAttribute("data-id");
    if (label ?? edge) return label ?? edge ?? null;
  }
  return null;
}
