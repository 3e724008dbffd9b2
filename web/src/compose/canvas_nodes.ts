// The cards on the canvas: those of the flow that is shown, and how they are moved and selected.
import { applyNodeChanges, type NodeChange, useReactFlow } from "@xyflow/react";
import { useEffect, useMemo, useRef, useState } from "react";
import { placeSteps, stepHeight, stepWidth } from "../cawl/placing";
import { inFlowOrder } from "../cawl/shown";
import { stepWords, type StepNode } from "../flow/step_card";
import { look } from "../ui/states";
import type { CanvasProps } from "./canvas";

const restMs = 350; // arrows that follow each other are one move
const glideMs = 260;

export function useNodes(props: CanvasProps): StepNode[] {
  const { shown, findings, serviceNames, selected, trial, breakpoints, onBreakpoint } = props;
  const order = useMemo(() => inFlowOrder(shown.steps, shown.links), [shown]);
  const places = useMemo(() => placeSteps(shown.steps, shown.links), [shown]);
  return useMemo(() => {
    const counts = new Map<string, { errors: number; warnings: number }>();
    for (const f of findings) {
      if (f.flow !== shown.flow.key || !f.step) continue;
      const count = counts.get(f.step) ?? { errors: 0, warnings: 0 };
      counts.set(
        f.step,
        f.error ? { ...count, errors: count.errors + 1 } : { ...count, warnings: count.warnings + 1 },
      );
    }
    return order.map((step): StepNode => {
      const { errors, warnings } = counts.get(step.key) ?? { errors: 0, warnings: 0 };
      const tried = trial?.get(step.name);
      const data = {
        step,
        serviceNames,
        errors,
        warnings,
        breakpoint: breakpoints.has(step.name),
        onBreakpoint,
        ...(tried && { state: tried.state, stateLabel: look(tried.state).words }),
        ...(tried?.differs && { differs: "the past run would differ here" }),
      };
      return {
        id: step.key,
        type: "step",
        data,
        position: places.get(step.key) ?? { x: 0, y: 0 },
        selected: selected.has(step.key),
        width: stepWidth,
        height: stepHeight(step),
        measured: { width: stepWidth, height: stepHeight(step) },
        deletable: !step.stale,
        draggable: !step.stale,
        ariaLabel: stepWords(data),
      };
    });
  }, [order, places, findings, serviceNames, selected, shown, trial, breakpoints, onBreakpoint]);
}

// The cards as they are drawn while some are moved. What is moved becomes an edit of the text when it rests.
export function useMovedNodes(props: CanvasProps, fromModel: StepNode[]) {
  const { actions, selectedLinks } = props;
  const flow = useReactFlow<StepNode>();
  const [nodes, setNodes] = useState(fromModel);
  const moved = useRef<Set<string>>(new Set());
  const timer = useRef(0);

  // What is being moved keeps its place, whatever else changes meanwhile.
  useEffect(() => {
    setNodes((before) => {
      if (moved.current.size === 0) return fromModel;
      const now = new Map(before.map((node) => [node.id, node]));
      return fromModel.map((node) => {
        const moving = moved.current.has(node.id) ? now.get(node.id) : undefined;
        return moving
          ? {
              ...node,
              position: moving.position,
              ...(moving.dragging !== undefined && { dragging: moving.dragging }),
            }
          : node;
      });
    });
  }, [fromModel]);

  const commit = () => {
    window.clearTimeout(timer.current);
    const keys = [...moved.current];
    moved.current.clear();
    const moves = keys.flatMap((key) => {
      const node = flow.getNode(key);
      return node ? [{ key, ...node.position }] : [];
    });
    if (moves.length > 0) actions.move(moves);
  };

  const onNodesChange = (changes: NodeChange<StepNode>[]) => {
    setNodes((before) => applyNodeChanges(changes, before));
    let selection: Set<string> | null = null;
    let byKeys = false;
    for (const change of changes) {
      if (change.type === "position" && change.position) {
        moved.current.add(change.id);
        if (change.dragging !== true) byKeys = true;
      } else if (change.type === "select") {
        selection ??= new Set(props.selected);
        if (change.selected) selection.add(change.id);
        else selection.delete(change.id);
      }
    }
    if (selection) props.onSelect([...selection], [...selectedLinks]);
    if (byKeys) {
      window.clearTimeout(timer.current);
      timer.current = window.setTimeout(commit, restMs);
    }
  };
  return { nodes, commit, onNodesChange };
}

// A layout that is not by hand may change with each edit: for a moment the cards glide there, so that the eye can follow.
export function useCalm(count: number, refreshed: number): boolean {
  const [calm, setCalm] = useState(false);
  useEffect(() => {
    setCalm(true);
    const t = window.setTimeout(() => setCalm(false), glideMs);
    return () => window.clearTimeout(t);
  }, [count, refreshed]);
  return calm;
}
