// What a deployment changes, drawn: the flow as it will be, with what comes and what changes marked, and what goes beside it.
import {
  Background,
  BackgroundVariant,
  getViewportForBounds,
  MarkerType,
  ReactFlow,
  ReactFlowProvider,
  useReactFlow,
} from "@xyflow/react";
import "@xyflow/react/dist/style.css";
import { useEffect, useEffectEvent, useMemo, useRef } from "react";
import type { Flow, Step } from "../cawl/document";
import { bothFlows, type Change } from "../cawl/flow_diff";
import { placeSteps, stepHeight, stepWidth } from "../cawl/placing";
import { beginning } from "../flow/refit";
import { LinkEdge, type LinkEdgeType } from "../flow/link_edge";
import { StepCard, stepWords, type StepNode } from "../flow/step_card";
import "../flow/canvas.css";
import "./deploy.css";

const nodeTypes = { step: StepCard };
const edgeTypes = { link: LinkEdge };
const words: Record<Change, string> = { new: "new", changed: "changed", gone: "goes" };
const readable = 0.6; // of a card's full size
const smallest = 0.45; // where steps beside each other have no room else
const nobody: ReadonlySet<string> = new Set();

export function DeployFlow(props: DeployFlowProps) {
  return (
    <ReactFlowProvider>
      <Drawing {...props} />
    </ReactFlowProvider>
  );
}

interface DeployFlowProps {
  before: Flow | undefined;
  after: Flow;
  textOf: (side: "before" | "after", step: Step) => string;
}

function Drawing(props: DeployFlowProps) {
  const { before, after, textOf } = props;
  const { steps, changes, links } = useMemo(() => bothFlows(before, after, textOf), [before, after, textOf]);
  const places = useMemo(
    () =>
      placeSteps(
        steps,
        links.map((l) => l.link),
      ),
    [steps, links],
  );
  const view = useReactFlow();
  const pane = useRef<HTMLDivElement>(null);
  const keys = new Map(steps.map((s) => [s.name, s.key]));
  const nodes = steps.map((step): StepNode => {
    const change = changes.get(step.name);
    const data = {
      step: { ...step, stale: false },
      errors: 0,
      warnings: 0,
      serviceNames: nobody,
      ...(change && { state: `diff-${change}`, stateLabel: words[change] }),
    };
    return {
      id: step.key,
      type: "step",
      data,
      position: places.get(step.key) ?? { x: 0, y: 0 },
      width: stepWidth,
      height: stepHeight(step),
      measured: { width: stepWidth, height: stepHeight(step) },
      focusable: false,
      ariaLabel: stepWords(data),
    };
  });
  const edges = links.flatMap(({ link, change }, i): LinkEdgeType[] => {
    const [source, target] = [keys.get(link.from), keys.get(link.to)];
    return source === undefined || target === undefined
      ? []
      : [
          {
            id: `${i}`,
            source,
            target,
            type: "link",
            className: `${link.kind} ${change && `diff-${change}`}`,
            data: { link: { ...link, stale: false } },
            focusable: false,
            markerEnd: { type: MarkerType.ArrowClosed, width: 15, height: 15, color: "context-stroke" },
          },
        ];
  });
  // What changes in view, in a size that can be read, as soon as the dialog has its size.
  const fit = useEffectEvent((box: HTMLElement) => {
    const marked = nodes.filter((n) => n.data.state);
    const shown = marked.length > 0 ? marked : nodes;
    const left = Math.min(...shown.map((n) => n.position.x));
    const top = Math.min(...shown.map((n) => n.position.y));
    const bounds = {
      x: left,
      y: top,
      width: Math.max(...shown.map((n) => n.position.x + stepWidth)) - left,
      height: Math.max(...shown.map((n) => n.position.y + (n.height ?? 0))) - top,
    };
    const fitting = getViewportForBounds(bounds, box.clientWidth, box.clientHeight, 0.1, 0.9, 0.12);
    if (box.clientWidth > 0)
      void view.setViewport(
        fitting.zoom >= readable ? fitting : beginning(bounds, box.clientWidth, readable, smallest),
      );
  });
  useEffect(() => {
    const box = pane.current;
    if (!box) return;
    const observer = new ResizeObserver(() => fit(box));
    observer.observe(box);
    return () => observer.disconnect();
  }, [view, places]);
  return (
    <div
      className="deploy-flow canvas"
      ref={pane}
      role="figure"
      aria-label={`The flow ${props.after.name}: ${[...changes].map(([name, change]) => `${name} ${words[change]}`).join(", ") || "only links or values change"}`}
    >
      <ReactFlow<StepNode, LinkEdgeType>
        nodes={nodes}
        edges={edges}
        nodeTypes={nodeTypes}
        edgeTypes={edgeTypes}
        nodesDraggable={false}
        nodesConnectable={false}
        elementsSelectable={false}
        nodesFocusable={false}
        edgesFocusable={false}
        deleteKeyCode={null}
        panOnScroll
        minZoom={0.1}
        onlyRenderVisibleElements={nodes.length > 120}
      >
        <Background variant={BackgroundVariant.Dots} gap={20} size={1.4} color="var(--dots)" />
      </ReactFlow>
    </div>
  );
}
