// Which part of the flow is in view: all of it at first and after a change of its layout, else the step at which something happens.
import { getViewportForBounds, useReactFlow } from "@xyflow/react";
import { type RefObject, useEffect, useRef, useState } from "react";
import { placed } from "../cawl/placing";
import type { LinkEdgeType } from "../flow/link_edge";
import { useRefit, withPiece } from "../flow/refit";
import type { StepNode } from "../flow/step_card";
import type { CanvasProps } from "./canvas";
import { lessMotion } from "./playing";

const readable = 0.8; // of a card's full size
const smallest = 0.5;

export function useView(
  props: CanvasProps,
  fromModel: readonly StepNode[],
  pane: RefObject<HTMLDivElement | null>,
) {
  const { shown } = props;
  const flow = useReactFlow<StepNode, LinkEdgeType>();
  const [asked] = useState(() => (props.selected.size === 1 ? ([...props.selected][0] ?? "") : "")); // the step of the address
  // The whole flow in view, by the places that the model has: the canvas may not have drawn them yet.
  const show = (largest: number) => {
    const box = pane.current?.getBoundingClientRect();
    if (!box || box.width === 0 || fromModel.length === 0) return;
    const left = Math.min(...fromModel.map((n) => n.position.x));
    const top = Math.min(...fromModel.map((n) => n.position.y));
    const bounds = {
      x: left,
      y: top,
      width: Math.max(...fromModel.map((n) => n.position.x + (n.width ?? 0))) - left,
      height: Math.max(...fromModel.map((n) => n.position.y + (n.height ?? 0))) - top,
    };
    const view = getViewportForBounds(bounds, box.width, box.height, 0.15, largest, 0.14);
    // A long flow begins at its top in a size that can be read.
    const zoom = Math.min(largest, readable);
    const whole =
      view.zoom >= smallest
        ? view
        : { x: box.width / 2 - (bounds.x + bounds.width / 2) * zoom, y: 28 - bounds.y * zoom, zoom };
    const wanted = props.selected.has(asked) ? fromModel.find((n) => n.id === asked) : undefined;
    void flow.setViewport(wanted ? withPiece(wanted, whole, box) : whole, {
      duration: lessMotion() ? 0 : 190,
    });
  };
  const latestShow = useRef(show);
  latestShow.current = show;
  useRefit(pane, fromModel, flow.getViewport, () => latestShow.current(1));
  const traced = props.trial !== null; // a panel has made the canvas smaller
  useEffect(() => {
    const t = window.setTimeout(() => latestShow.current(1), 60);
    return () => window.clearTimeout(t);
  }, [flow, shown.flow.key, props.refreshed, traced]);
  // The step at which a simulation is comes into view.
  const isIn = (state: string) => shown.steps.find((s) => props.trial?.get(s.name)?.state === state)?.key;
  const active = isIn("running") ?? isIn("waiting") ?? "";
  const latestNodes = useRef(fromModel);
  latestNodes.current = fromModel;
  useEffect(() => {
    const t = window.setTimeout(() => {
      const node = latestNodes.current.find((n) => n.id === active);
      const box = pane.current?.getBoundingClientRect();
      const before = flow.getViewport();
      const view = node && box ? withPiece(node, before, box) : before;
      if (view !== before) void flow.setViewport(view, { duration: lessMotion() ? 0 : 190 });
    }, 120); // after the whole flow was shown
    return () => window.clearTimeout(t);
  }, [flow, pane, active]);
  const count = shown.steps.length;
  const placedByHand = placed(shown.steps);
  useEffect(() => {
    if (placedByHand) return;
    const t = window.setTimeout(() => latestShow.current(Math.min(1, Math.max(0.6, flow.getZoom()))), 60);
    return () => window.clearTimeout(t);
  }, [flow, count, placedByHand]);
}
