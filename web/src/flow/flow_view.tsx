// The flow of a run, with the state of each node; nothing can be changed here.
import {
  Background,
  BackgroundVariant,
  Controls,
  MarkerType,
  ReactFlow,
  ReactFlowProvider,
  useReactFlow,
} from "@xyflow/react";
import "@xyflow/react/dist/style.css";
import { useEffect, useMemo, useRef } from "react";
import type { Flow } from "../cawl/document";
import { placeSteps, stepHeight, stepWidth } from "../cawl/placing";
import { inFlowOrder } from "../cawl/shown";
import { LinkEdge, type LinkEdgeType } from "./link_edge";
import { useRefit } from "./refit";
import { StepCard, stepWords, type StepNode } from "./step_card";
import type { Run } from "../gen/docent/v1/workflows_pb";
import { look } from "../ui/states";
import "./canvas.css";
import "./flow_view.css";

const nodeTypes = { step: StepCard };
const edgeTypes = { link: LinkEdge };

export function FlowView(props: {
  flow: Flow;
  run: Run;
  serviceNames: ReadonlySet<string>;
  picked: string;
  onPick: (node: string) => void;
}) {
  return (
    <ReactFlowProvider>
      <View {...props} />
    </ReactFlowProvider>
  );
}

function View({
  flow,
  run,
  serviceNames,
  picked,
  onPick,
}: {
  flow: Flow;
  run: Run;
  serviceNames: ReadonlySet<string>;
  picked: string;
  onPick: (node: string) => void;
}) {
  const view = useReactFlow();
  const places = useMemo(() => placeSteps(flow.steps, flow.links), [flow]);
  const order = useMemo(() => inFlowOrder(flow.steps, flow.links), [flow]);
  const states = new Map(run.nodes.map((n) => [n.name, n.state]));
  const nodes = order.map((step): StepNode => {
    const state =
      states.get(step.name) ??
      (step.kind === "source" ? "done" : step.kind === "sink" && run.state === "done" ? "done" : "");
    const data = {
      step: { ...step, stale: false },
      errors: 0,
      warnings: 0,
      serviceNames,
      ...(state && { state }),
      ...(state && step.kind === "node" && { stateLabel: look(state).words }),
    };
    return {
      id: step.key,
      type: "step",
      data,
      position: places.get(step.key) ?? { x: 0, y: 0 },
      width: stepWidth,
      height: stepHeight(step),
      measured: { width: stepWidth, height: stepHeight(step) },
      selected: picked === step.name,
      ariaLabel: stepWords(data),
      focusable: step.kind === "node",
    };
  });
  const keys = new Map(flow.steps.map((s) => [s.name, s.key]));
  const edges = flow.links.flatMap((link): LinkEdgeType[] => {
    const source = keys.get(link.from);
    const target = keys.get(link.to);
    if (source === undefined || target === undefined) return [];
    const reached =
      ["running", "done", "waiting", "incident", "failed"].includes(states.get(link.to) ?? "") ||
      (run.state === "done" && flow.steps.find((s) => s.name === link.to)?.kind === "sink");
    const followed =
      reached &&
      (states.get(link.from) === "done" || flow.steps.find((s) => s.name === link.from)?.kind === "source");
    return [
      {
        id: link.key,
        source,
        target,
        type: "link",
        className: `${link.kind}${followed ? " followed" : ""}`,
        data: { link: { ...link, stale: false } },
        focusable: false,
        markerEnd: { type: MarkerType.ArrowClosed, width: 15, height: 15, color: "context-stroke" },
      },
    ];
  });
  useEffect(() => {
    const timer = window.setTimeout(() => void view.fitView({ padding: 0.14, maxZoom: 1 }), 60);
    return () => window.clearTimeout(timer);
  }, [view, flow]);
  const pane = useRef<HTMLDivElement>(null);
  useRefit(pane, nodes, view.getViewport, () => void view.fitView({ padding: 0.14, maxZoom: 1 }));
  return (
    <div className="canvas run-canvas" ref={pane}>
      <ReactFlow<StepNode, LinkEdgeType>
        nodes={nodes}
        edges={edges}
        nodeTypes={nodeTypes}
        edgeTypes={edgeTypes}
        nodesDraggable={false}
        nodesConnectable={false}
        deleteKeyCode={null}
        panOnScroll
        fitView={nodes.length <= 120}
        fitViewOptions={{ padding: 0.14, maxZoom: 1 }}
        minZoom={0.15}
        onlyRenderVisibleElements={nodes.length > 120}
        onNodeClick={(_, node) => onPick(node.data.step.kind === "node" ? node.data.step.name : "")}
        onPaneClick={() => onPick("")}
        onNodesChange={(changes) => {
          for (const c of changes) if (c.type === "select" && c.selected) onPick(c.id);
        }}
      >
        <Background variant={BackgroundVariant.Dots} gap={20} size={1.4} color="var(--dots)" />
        <Controls showInteractive={false} position="bottom-right" />
      </ReactFlow>
    </div>
  );
}
